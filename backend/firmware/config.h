/* Objects by their number (oid), made by config commands before finalize_config. */
#ifndef CONFIG_H
#define CONFIG_H

#include <stdbool.h>
#include <stdint.h>

#include "runs.h"

enum kind { KIND_NONE, KIND_STEPPER, KIND_OUTPUT, KIND_ENDSTOP, KIND_TRSYNC };

/* These stop the board and give NULL, false or NONE when it cannot be. */
void *object_new(uint8_t oid, enum kind kind, uint16_t size);
void *object_of(uint8_t oid, enum kind kind);
bool config_finished(void);
bool output_pin(uint32_t pin, bool high);
link_t place_take(void);

#endif
