/* The two boards: clock, pins, memory. A pin's number is 8 for each port letter from A on, and its bit. */
#ifndef BOARD_H
#define BOARD_H

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdbool.h>
#include <stdint.h>

#define CLOCK_HZ 16000000UL
#define BAUD 250000UL

#if defined(__AVR_ATmega2560__)
#define ARENA_SIZE 6600 /* objects and stored runs, bytes */
typedef uint16_t link_t;
#elif defined(__AVR_ATmega328P__)
#define ARENA_SIZE 1150
typedef uint8_t link_t;
#else
#error "no such board"
#endif

/* The port register of a pin for reading and toggling (PINx; DDRx and PORTx follow it), or NULL. */
typedef volatile uint8_t *port_t;
port_t pin_port(uint32_t pin);

static inline uint8_t pin_mask(uint8_t pin)
{
    return 1 << (pin & 7);
}

/* True when the pin exists and serves neither the serial line nor another purpose; each is given away once. */
bool pin_claim(uint32_t pin);
void pins_release(void);
void pin_drive(uint8_t pin, bool high);
void pin_listen(uint8_t pin, bool pull_up);

/* Interrupts off for a few instructions. */
static inline uint8_t lock(void)
{
    uint8_t before = SREG;
    cli();
    return before;
}

static inline void unlock(uint8_t before)
{
    __asm__ __volatile__("" ::: "memory");
    SREG = before;
}

#endif
