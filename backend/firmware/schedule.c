/* Steps and other events in the order of their ticks.
 *
 * One interrupt handler does everything that is due. A step has two parts: the pin changes first (`stepper_fire`), the next
 * step is worked out afterwards (`stepper_finish`). Motors that step together so change their pins within a few
 * microseconds of each other, and no motor's arithmetic delays another's pin by more than one such part. */
#include "schedule.h"

#include <stddef.h>

#include "stepper.h"
#include "stop.h"

#define ENTRY 245     /* cycles from the compare match to the first change of a pin */
#define STAY (ENTRY + 60) /* what is due sooner than this is waited for in the handler */
#define LONGEST_STAY 1200 /* cycles, about two bytes of the serial line */
#define BREATH 160        /* cycles: the way out of the handler, and the serial line's one */
#define NEAR 0x4000   /* ticks in which 16-bit arithmetic is enough */
#define TOO_LATE 4000     /* cycles, a quarter of a millisecond: the processor does not keep up */

volatile uint16_t clock_middle;
volatile uint16_t clock_top;

static struct timer *first_due;

void clock_start(void)
{
    TCCR1A = 0;
    TCCR1B = _BV(CS10);
    OCR1A = 0x8000;
    TIMSK1 = _BV(TOIE1) | _BV(OCIE1A);
}

static inline __attribute__((always_inline)) void count_overflow(void)
{
    if (++clock_middle == 0)
        ++clock_top;
}

ISR(TIMER1_OVF_vect)
{
    count_overflow();
}

static inline __attribute__((always_inline)) uint32_t read_clock(void)
{
    union {
        struct {
            uint16_t low, middle;
        };
        uint32_t whole;
    } now;
    now.low = TCNT1;
    now.middle = clock_middle;
    if ((TIFR1 & _BV(TOV1)) && now.low < 0x8000)
        now.middle++; /* the overflow is not counted yet */
    return now.whole;
}

uint32_t clock_locked(void)
{
    return read_clock();
}

uint32_t clock_now(void)
{
    uint8_t before = lock();
    uint32_t now = read_clock();
    unlock(before);
    return now;
}

uint32_t clock_high(uint32_t *low)
{
    uint8_t before = lock();
    uint32_t now = read_clock();
    uint32_t high = clock_top;
    if ((now >> 16) == 0 && clock_middle == 0xffff)
        high++;
    unlock(before);
    *low = now;
    return high;
}

/* simavr 1.6 loses a match right after the overflow. */
static inline __attribute__((always_inline)) void set_match(uint16_t at)
{
    OCR1A = at < 16 ? 16 : at;
}

static inline __attribute__((always_inline)) void insert(struct timer *timer, uint32_t behind)
{
    struct timer **at = &first_due, *other;
    while ((other = *at) != NULL && (int32_t)(behind - other->wake) >= 0)
        at = &other->next;
    timer->next = other;
    *at = timer;
}

static void wake_for(struct timer *timer)
{
    if (first_due != timer)
        return;
    int32_t ahead = timer->wake - read_clock();
    if (ahead < ENTRY + 200)
        set_match(TCNT1 + 40);
    else
        set_match((uint16_t)timer->wake - ENTRY);
}

void schedule_add(struct timer *timer)
{
    insert(timer, timer->wake);
    wake_for(timer);
}

void schedule_add_before_equals(struct timer *timer)
{
    insert(timer, timer->wake - 1);
    wake_for(timer);
}

void schedule_remove(struct timer *timer)
{
    for (struct timer **at = &first_due; *at != NULL; at = &(*at)->next)
        if (*at == timer) {
            *at = timer->next;
            return;
        }
}

void schedule_clear(void)
{
    first_due = NULL;
}

ISR(TIMER1_COMPA_vect)
{
    if (TIFR1 & _BV(TOV1)) { /* at a high rate of steps its own handler would wait for longer than half a period */
        TIFR1 = _BV(TOV1);
        count_overflow();
    }
    uint32_t entered = read_clock();
    struct timer *fired = NULL, **end = &fired; /* motors whose pulse began, in order */
    for (;;) {
        struct timer *timer = first_due;
        int16_t left = NEAR, stayed = TCNT1 - (uint16_t)entered;
        if (timer != NULL) {
            int32_t ahead = timer->wake - entered;
            if (ahead < NEAR)
                left = (int16_t)ahead - stayed;
        }
        if (left <= EARLY) {
            if (timer->fire == NULL) {
                uint32_t tick = timer->wake;
                do { /* all motors of this tick, or nearly */
                    stepper_fire((struct stepper *)timer);
                    *end = timer;
                    end = &timer->next;
                    timer = timer->next;
                } while (timer != NULL && timer->fire == NULL && timer->wake - tick <= EARLY);
                *end = NULL;
                first_due = timer;
            } else {
                first_due = timer->next;
                if (timer->fire(timer))
                    insert(timer, timer->wake);
            }
            if (left < -TOO_LATE || stayed > TOO_LATE)
                stop_from_interrupt(STOP_LATE);
        } else if (fired != NULL) {
            timer = fired;
            fired = timer->next;
            if (fired == NULL)
                end = &fired;
            if (stepper_finish((struct stepper *)timer))
                insert(timer, timer->wake);
        } else if (left > STAY) {
            if (timer == NULL)
                return;
            uint16_t match = (uint16_t)timer->wake - ENTRY;
            set_match(match);
            if (left == NEAR || (int16_t)(match - TCNT1) > 0)
                return; /* the match is still to come */
        } else if (stayed > LONGEST_STAY) {
            set_match(TCNT1 + BREATH); /* lets other interrupts in */
            return;
        }
    }
}
