/* Digital outputs: changed at their tick; in a shutdown at their default. */
#ifndef OUTPUT_H
#define OUTPUT_H

void outputs_halt(void);
void outputs_settle(void);
void outputs_reset(void);

#endif
