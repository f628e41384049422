#include "vlq.h"

#include "uart.h"

uint8_t vlq_write(uint8_t *to, uint32_t value)
{
    int32_t number = value;
    uint8_t length = 0;
    if (number >= 3L << 26 || number < -(1L << 26))
        to[length++] = 0x80 | (uint8_t)((int8_t)(value >> 24) >> 4);
    if (number >= 3L << 19 || number < -(1L << 19))
        to[length++] = 0x80 | (uint8_t)((uint16_t)(value >> 16) >> 5);
    if (number >= 3L << 12 || number < -(1L << 12))
        to[length++] = 0x80 | (uint8_t)((uint16_t)(value >> 8) >> 6);
    if (number >= 3L << 5 || number < -(1L << 5))
        to[length++] = 0x80 | (uint8_t)((uint16_t)value >> 7);
    to[length++] = value & 0x7f;
    return length;
}

bool vlq_read(uint8_t *at, uint8_t end, uint32_t *value)
{
    if (*at >= end)
        return false;
    uint8_t byte = rx_at((*at)++);
    uint32_t number = byte & 0x7f;
    if ((byte & 0x60) == 0x60)
        number |= ~0x1fUL; /* negative */
    for (uint8_t more = 1; byte & 0x80; more++) {
        if (more == VLQ_LONGEST || *at >= end)
            return false;
        byte = rx_at((*at)++);
        number = number << 7 | (byte & 0x7f);
    }
    *value = number;
    return true;
}
