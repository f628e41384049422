#include "board.h"

#include <stddef.h>
#include <string.h>

#if defined(__AVR_ATmega2560__)
#define PORTS 12
#define SERIAL_PIN 32 /* PE0 and PE1 */
#else
#define PORTS 4
#define SERIAL_PIN 24 /* PD0 and PD1 */
#endif

static uint8_t claimed[PORTS];

port_t pin_port(uint32_t pin)
{
    uint8_t port = pin >> 3;
    if (pin >= 8 * PORTS)
        return NULL;
#if defined(__AVR_ATmega2560__)
    if (port == 8) /* there is no port I */
        return NULL;
    if (port > 8)
        port--;
    return port < 7 ? &PINA + 3 * port : &PINH + 3 * (port - 7);
#else
    if (port == 0)
        return NULL;
    return &PINB + 3 * (port - 1);
#endif
}

bool pin_claim(uint32_t pin)
{
    if (pin_port(pin) == NULL || (pin & ~1UL) == SERIAL_PIN || (claimed[pin >> 3] & pin_mask(pin)))
        return false;
    claimed[pin >> 3] |= pin_mask(pin);
    return true;
}

void pins_release(void)
{
    memset(claimed, 0, sizeof claimed);
}

void pin_drive(uint8_t pin, bool high)
{
    port_t port = pin_port(pin);
    uint8_t mask = pin_mask(pin), before = lock();
    if (high)
        port[2] |= mask;
    else
        port[2] &= ~mask;
    port[1] |= mask;
    unlock(before);
}

void pin_listen(uint8_t pin, bool pull_up)
{
    port_t port = pin_port(pin);
    uint8_t mask = pin_mask(pin), before = lock();
    port[1] &= ~mask;
    if (pull_up)
        port[2] |= mask;
    else
        port[2] &= ~mask;
    unlock(before);
}
