/* What a certified run needs beyond Klipper's protocol (docs/boards.md); nothing of it in the plain profile.
 *
 * No motor steps before the host has presented the identity of a stream and opened a section. The host promises up to which
 * tick everything was sent; past it all motors stop together. Each motor's executed runs are counted and hashed. */
#ifndef PROOF_H
#define PROOF_H

#include <stdbool.h>
#include <stdint.h>

#include "runs.h"

struct stepper;

#ifdef CERTIFIED
/* Runs that were executed one after the other without a seam, as one. */
struct record {
    uint32_t interval;
    uint32_t count;
    int16_t add;
    bool forward;
};

struct account {
    uint32_t steps; /* pulses since the section began, both ways */
    uint32_t crc;   /* of all closed records, without the last exclusive or */
    struct record open;
};

bool proof_allows(void);
void proof_made(struct account *account, const struct run *run, uint16_t made);
void proof_base(struct account *account, uint32_t clock);
void proof_halt(void);
void proof_reset(void);
void proof_task(void);
#else
static inline bool proof_allows(void)
{
    return true;
}
static inline void proof_halt(void)
{
}
static inline void proof_reset(void)
{
}
static inline void proof_task(void)
{
}
#endif

#endif
