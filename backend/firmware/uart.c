/* Two rings. Interrupt handlers are short: a step that is due waits for them. */
#include "uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdbool.h>

#include "board.h"

static uint8_t rx_ring[RX_SIZE];
static volatile uint8_t rx_head; /* written by the interrupt */
static volatile uint8_t rx_tail; /* written by the main loop */

static uint8_t tx_ring[TX_SIZE];
static volatile uint8_t tx_head;
static volatile uint8_t tx_tail;
static uint8_t tx_next; /* behind the last byte put, not published yet */

#if defined(__AVR_ATmega2560__)
#define RX_VECTOR USART0_RX_vect
#define TX_VECTOR USART0_UDRE_vect
#else
#define RX_VECTOR USART_RX_vect
#define TX_VECTOR USART_UDRE_vect
#endif

void uart_start(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = CLOCK_HZ / 8 / BAUD - 1;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

ISR(RX_VECTOR)
{
    uint8_t byte = UDR0;
    uint8_t head = rx_head;
    uint8_t next = head + 1;
    if (next == RX_SIZE)
        next = 0;
    if (next == rx_tail)
        return; /* a host that keeps to the window never gets here; the block's CRC tells otherwise */
    rx_ring[head] = byte;
    rx_head = next;
}

ISR(TX_VECTOR)
{
    uint8_t tail = tx_tail;
    UDR0 = tx_ring[tail];
    if (++tail == TX_SIZE)
        tail = 0;
    tx_tail = tail;
    if (tail == tx_head)
        UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

uint8_t rx_count(void)
{
    uint8_t head = rx_head, tail = rx_tail;
    return head >= tail ? head - tail : head + RX_SIZE - tail;
}

static uint8_t rx_place(uint8_t place)
{
    uint16_t at = (uint16_t)rx_tail + place;
    return at >= RX_SIZE ? at - RX_SIZE : at;
}

uint8_t rx_at(uint8_t place)
{
    return rx_ring[rx_place(place)];
}

void rx_take(uint8_t count)
{
    rx_tail = rx_place(count);
}

static uint8_t tx_free(void)
{
    uint8_t tail = tx_tail, head = tx_head;
    return (tail > head ? tail - head : tail + TX_SIZE - head) - 1;
}

void tx_begin(uint8_t count)
{
    while (tx_free() < count) {
    }
    tx_next = tx_head;
}

void tx_put(uint8_t byte)
{
    tx_ring[tx_next] = byte;
    if (++tx_next == TX_SIZE)
        tx_next = 0;
}

void tx_send(void)
{
    uint8_t interrupts = SREG;
    cli();
    tx_head = tx_next;
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0) | _BV(UDRIE0);
    SREG = interrupts;
}
