/* Whole numbers in groups of seven bits, the highest first. */
#ifndef VLQ_H
#define VLQ_H

#include <stdbool.h>
#include <stdint.h>

#define VLQ_LONGEST 5

uint8_t vlq_write(uint8_t *to, uint32_t value);

/* Reads at place `*at` of the received bytes and moves it on; false when the number does not end before `end`. */
bool vlq_read(uint8_t *at, uint8_t end, uint32_t *value);

#endif
