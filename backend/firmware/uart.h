/* The serial line: 250 kbaud, 8N1, both ways by interrupt. */
#ifndef UART_H
#define UART_H

#include <stdint.h>

#define RX_SIZE 192 /* what the host may have in flight (RECEIVE_WINDOW of the dictionary) */
#define TX_SIZE 96  /* a whole block, 64 bytes, has to fit */

void uart_start(void);

/* Received bytes not taken yet, and the byte at one place of them. */
uint8_t rx_count(void);
uint8_t rx_at(uint8_t place);
void rx_take(uint8_t count);

/* Room for `count` bytes, waited for; then they are put and published together. */
void tx_begin(uint8_t count);
void tx_put(uint8_t byte);
void tx_send(void);

#endif
