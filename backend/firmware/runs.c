#include "runs.h"

#include <stddef.h>
#include <string.h>

static uint8_t arena[ARENA_SIZE];
static uint16_t arena_used;
static link_t unused;

struct run *runs;
uint16_t run_places;

void *arena_take(uint16_t size)
{
    if (size > ARENA_SIZE - arena_used)
        return NULL;
    void *taken = arena + arena_used;
    arena_used += size;
    return memset(taken, 0, size);
}

void arena_reset(void)
{
    arena_used = 0;
    run_places = 0;
    unused = NONE;
}

bool arena_finish(void)
{
    uint16_t places = (ARENA_SIZE - arena_used) / sizeof(struct run);
    if (places > NONE)
        places = NONE;
    runs = (struct run *)(arena + arena_used);
    run_places = places;
    runs_reset();
    return places > 0;
}

void runs_reset(void)
{
    unused = NONE;
    for (uint16_t place = run_places; place-- > 0;)
        run_return(place);
}

link_t run_take(void)
{
    link_t place = unused;
    if (place != NONE)
        unused = runs[place].next;
    return place;
}

void run_return(link_t place)
{
    runs[place].next = unused;
    unused = place;
}
