/* Inputs that stop motors: limit switches, probes. */
#ifndef ENDSTOP_H
#define ENDSTOP_H

void endstops_halt(void);
void endstops_reset(void);
void endstops_task(void);

#endif
