/* Runs a firmware on a simulated AVR: its serial line is a pseudo-terminal, every change of a pin is written with its cycle.
 *
 *     runner atmega328p|atmega2560 FILE.elf|FILE.hex EDGES SPEED
 *
 * It prints "port NAME" once, the terminal to open. EDGES gets 8 bytes a change, little-endian: cycle * 2^16 + pin * 2^8 + level;
 * a pin's number is 8 for each port letter from A on, and its bit. SPEED: times real time, 0 as fast as it goes, "told": time
 * passes only as the host says, so that a run does not depend on how busy this machine is.
 * Lines on its standard input:
 *     set PIN LEVEL               an input gets this level now
 *     after OUT COUNT PIN LEVEL   ... when the output OUT has risen COUNT times more
 *     flush                       writes out the edges, then prints "flushed CYCLE START SPARE": now, when timer 1 began to count, and how
 *                               many bytes of RAM neither data nor stack ever touched
 *     speed SPEED                 times real time from now on
 *     until CYCLE SENT            (told) when SENT bytes in all have come from the terminal, time passes until that cycle, or until
 *                               the board has said something and is silent again; then "at CYCLE SAID": now, bytes it has sent in all
 * It ends with its standard input. Written for simavr 1.6. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
#include <sim_hex.h>

#define HZ 16000000
#define TCCR1B 0x81 /* on both chips; its low bits start the timer */
#define FIRST_RAM 0x100
#define PAINT 0xa5
#define LOOK 3200 /* cycles between looks at terminal and standard input */
#define SILENCE 2000 /* cycles, three bytes of the line: nothing more belongs to what was said */

static avr_t *avr;
static FILE *edges;
static int terminal;
static bool ready = true; /* the UART takes bytes */
static avr_irq_t *serial_in;
static uint8_t levels[96];
static avr_cycle_count_t timer_began, begun_cycle;
static struct timespec begun;
static double speed;
static bool told;
static avr_cycle_count_t told_until, said_at;
static unsigned long long come, come_wanted, said, said_before;
static struct {
    uint8_t out, in, level;
    uint32_t count;
} trip;

static void quiet(avr_t *of, const int level, const char *format, va_list values)
{
    (void)of;
    if (level <= LOG_ERROR)
        vfprintf(stderr, format, values);
}

static void set_pin(uint8_t pin, uint8_t level)
{
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('A' + pin / 8), pin % 8), level);
}

static void pin_changed(struct avr_irq_t *irq, uint32_t value, void *parameter)
{
    (void)irq;
    uint8_t pin = (uintptr_t)parameter, level = value & 1;
    if (levels[pin] == level)
        return;
    levels[pin] = level;
    uint64_t row = avr->cycle << 16 | pin << 8 | level;
    fwrite(&row, sizeof row, 1, edges);
    if (trip.count > 0 && pin == trip.out && level && --trip.count == 0)
        set_pin(trip.in, trip.level);
}

static void serial_out(struct avr_irq_t *irq, uint32_t value, void *parameter)
{
    (void)irq, (void)parameter;
    uint8_t byte = value;
    said++;
    said_at = avr->cycle;
    while (write(terminal, &byte, 1) < 0 && errno == EINTR) {
    } /* a host that does not read loses bytes, as on a wire */
}

static void line_free(struct avr_irq_t *irq, uint32_t value, void *parameter)
{
    (void)irq, (void)value, (void)parameter;
    ready = true;
}

static void line_full(struct avr_irq_t *irq, uint32_t value, void *parameter)
{
    (void)irq, (void)value, (void)parameter;
    ready = false;
}

static uint8_t waiting[4096];
static size_t waits_from, waits_to;

static void look_at_terminal(void)
{
    memmove(waiting, waiting + waits_from, waits_to - waits_from);
    waits_to -= waits_from;
    waits_from = 0;
    do {
        ssize_t count = read(terminal, waiting + waits_to, sizeof waiting - waits_to);
        if (count > 0)
            waits_to += count, come += count;
    } while (told && come < come_wanted); /* what was sent is here a moment later */
    while (ready && waits_from < waits_to)
        avr_raise_irq(serial_in, waiting[waits_from++]);
}

/* The longest stretch of RAM that still has the paint. */
static unsigned spare(void)
{
    unsigned longest = 0, here = 0;
    for (uint32_t at = FIRST_RAM; at <= avr->ramend; at++) {
        here = avr->data[at] == PAINT ? here + 1 : 0;
        if (here > longest)
            longest = here;
    }
    return longest;
}

static void begin_pace(void)
{
    clock_gettime(CLOCK_MONOTONIC, &begun);
    begun_cycle = avr->cycle;
}

static void obey(const char *line)
{
    unsigned a, b, c, d;
    unsigned long long cycle;
    if (sscanf(line, "set %u %u", &a, &b) == 2) {
        set_pin(a, b);
    } else if (sscanf(line, "after %u %u %u %u", &a, &b, &c, &d) == 4) {
        trip.out = a, trip.count = b, trip.in = c, trip.level = d;
    } else if (sscanf(line, "speed %lf", &speed) == 1) {
        begin_pace();
    } else if (sscanf(line, "until %llu %llu", &cycle, &come_wanted) == 2) {
        told_until = cycle;
        said_before = said;
        look_at_terminal();
    } else if (strncmp(line, "flush", 5) == 0) {
        fflush(edges);
        printf("flushed %llu %llu %u\n", (unsigned long long)avr->cycle, (unsigned long long)timer_began, spare());
        fflush(stdout);
    }
}

/* Takes what is there, or waits for it; false at the end of the standard input. */
static bool look_at_input(bool wait)
{
    static char text[256];
    static size_t length;
    struct pollfd input = {.fd = 0, .events = POLLIN};
    if (poll(&input, 1, wait ? -1 : 0) <= 0)
        return true;
    ssize_t count = read(0, text + length, sizeof text - 1 - length);
    if (count <= 0)
        return false;
    length += count;
    text[length] = 0;
    for (char *end; (end = strchr(text, '\n')) != NULL;) {
        *end = 0;
        obey(text);
        length -= end + 1 - text;
        memmove(text, end + 1, length + 1);
    }
    return true;
}

static void load(const char *path)
{
    const char *dot = strrchr(path, '.');
    if (dot != NULL && strcmp(dot, ".hex") == 0) {
        uint32_t size, start;
        uint8_t *code = read_ihex_file(path, &size, &start);
        if (code == NULL)
            exit(2);
        avr_loadcode(avr, code, size, start);
        avr->codeend = start + size;
        free(code);
    } else {
        static elf_firmware_t firmware;
        if (elf_read_firmware(path, &firmware) != 0)
            exit(2);
        avr_load_firmware(avr, &firmware);
    }
}

static void open_terminal(void)
{
    int other; /* stays open, or the terminal would end with its first user */
    char name[128];
    struct termios raw;
    memset(&raw, 0, sizeof raw);
    cfmakeraw(&raw);
    if (openpty(&terminal, &other, name, &raw, NULL) != 0)
        exit(2);
    fcntl(terminal, F_SETFL, O_NONBLOCK);
    printf("port %s\n", name);
    fflush(stdout);
}

static void connect_pins(void)
{
    for (uintptr_t pin = 0; pin < sizeof levels; pin++) {
        avr_irq_t *irq = avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('A' + pin / 8), pin % 8);
        if (irq != NULL)
            avr_irq_register_notify(irq, pin_changed, (void *)pin);
    }
    uint32_t flags = 0;
    avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    serial_in = avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), serial_out, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XON), line_free, NULL);
    avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUT_XOFF), line_full, NULL);
}

static void keep_pace(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    double passed = now.tv_sec - begun.tv_sec + (now.tv_nsec - begun.tv_nsec) * 1e-9;
    double ahead = (avr->cycle - begun_cycle) / (speed * HZ) - passed;
    if (ahead > 0.0005)
        usleep(ahead * 1e6);
}

/* Told: waits until time may pass again; false at the end of the standard input. */
static bool wait_to_be_told(void)
{
    if (avr->cycle < told_until && (said == said_before || avr->cycle - said_at < SILENCE))
        return true;
    if (told_until > 0) {
        printf("at %llu %llu\n", (unsigned long long)avr->cycle, said);
        fflush(stdout);
    }
    told_until = 0;
    while (told_until == 0)
        if (!look_at_input(true))
            return false;
    return true;
}

int main(int count, char **words)
{
    if (count != 5)
        return 2;
    avr_global_logger_set(quiet);
    avr = avr_make_mcu_by_name(words[1]);
    edges = fopen(words[3], "wb");
    told = strcmp(words[4], "told") == 0;
    speed = told ? 0 : atof(words[4]);
    if (avr == NULL || edges == NULL)
        return 2;
    avr_init(avr);
    avr->frequency = HZ;
    load(words[2]);
    memset(avr->data + FIRST_RAM, PAINT, avr->ramend + 1 - FIRST_RAM);
    open_terminal();
    connect_pins();
    begin_pace();
    for (avr_cycle_count_t next = 0;;) {
        int state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed)
            break;
        if (timer_began == 0 && (avr->data[TCCR1B] & 7) != 0)
            timer_began = avr->cycle;
        if (told && !wait_to_be_told())
            break;
        if (avr->cycle < next)
            continue;
        next = avr->cycle + LOOK;
        look_at_terminal();
        if (!told && !look_at_input(false))
            break;
        if (speed > 0)
            keep_pace();
    }
    fclose(edges);
    return 0;
}
