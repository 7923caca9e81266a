/* A drive in C whose bus voltage is told by WORDS words: interrupts strike before every access, nest, and end calls for
 * good, which count as given up after GIVEN_UP periods. Every failed check prints its line; the program ends with their number. */
#include "hub_drive.h"
#include <setjmp.h>
#include <stdio.h>

#define STALE 2000
/* More accesses than any scenario makes. */
#define BEHIND 40

static hub_drive_t drive;
static int failures;
static int accesses;
static jmp_buf killed;

/* What strikes before an access, counted over all contexts; none where it is -1. */
static int kill_at = -1;
static struct {
    int at;
    void (*run)(void);
} pending[2] = { { -1, 0 }, { -1, 0 } };

#define CHECK(what) \
    do { \
        if (!(what)) { \
            failures += 1; \
            printf("line %d: %s\n", __LINE__, #what); \
        } \
    } while (0)

void hook(void)
{
    const int now = accesses++;
    if (now == kill_at) {
        kill_at = -1;
        longjmp(killed, 1);
    }
    for (int which = 0; which < 2; which++) {
        if (now == pending[which].at) {
            pending[which].at = -1;
            pending[which].run();
        }
    }
}

static void step(void)
{
    (void)hub_drive_step(&drive, 2048, 2048, 1);
}

static bool is_stale(void)
{
    return hub_drive_status(&drive).bus_is_stale;
}

static void start(void)
{
    hub_drive_init(&drive);
    accesses = 0;
    kill_at = -1;
    pending[0].at = -1;
    pending[1].at = -1;
}

/* The words that the control loop goes by: of which call, 1 to 4, or 0 where they are of two. */
static int32_t known[5][2];
static const uint16_t counts[5] = { 0, 2000, 2200, 2400, 2600 };

static void read_words(int32_t words[2])
{
#if WORDS == 2
    const int bank = (drive.set_point.bus.published == 0) ? 0 : 1;
    words[0] = drive.set_point.bus.banks[bank][0];
    words[1] = drive.set_point.bus.banks[bank][1];
#else
    words[0] = drive.set_point.v_bus;
    words[1] = 0;
#endif
}

static int told(void)
{
    int32_t words[2];
    read_words(words);
    for (int call = 1; call <= 4; call++) {
        if (words[0] == known[call][0] && words[1] == known[call][1]) {
            return call;
        }
    }
    return 0;
}

static void set(int call)
{
    hub_drive_set_bus(&drive, counts[call]);
}

static void set_3(void)
{
    set(3);
}

static void look(void)
{
    CHECK(told() != 0);
    step();
}

static void shows_that_calls_cease(void)
{
    start();
    CHECK(is_stale());
    step();
    CHECK(is_stale());
    for (int again = 0; again < 2; again++) {
        set(2);
        for (int period = 0; period < STALE; period++) {
            step();
            CHECK(!is_stale());
        }
        for (int period = 0; period < 3 * STALE; period++) {
            step();
            CHECK(is_stale());
        }
    }
    hub_drive_reset(&drive);
    CHECK(is_stale());
}

/* Ends a call before an access; false where it has none there. */
static bool kill_a_call(int access)
{
    accesses = 0;
    kill_at = access;
    if (setjmp(killed) == 0) {
        set(3);
        kill_at = -1;
        return false;
    }
    return true;
}

static void shows_a_call_that_ended_for_good(void)
{
    int ended = 0;
    int held_up = 0;
    for (int access = 0; access < BEHIND; access++) {
        start();
        set(2);
        step();
        if (!kill_a_call(access)) {
            continue;
        }
        ended += 1;
        CHECK(told() == 2 || told() == 3);
        long held = 0;
        long stale = 0;
        for (long period = 0; period < 2L * GIVEN_UP; period++) {
            set(4);
            step();
            held += (told() != 4) ? 1 : 0;
            stale += is_stale() ? 1 : 0;
            CHECK(told() != 0);
            CHECK(told() != 4 || !is_stale());
        }
        CHECK(told() == 4 && !is_stale());
        CHECK(held == 0 || held == GIVEN_UP);
        CHECK(held == 0 || stale >= held - STALE);
        held_up += (stale > 0) ? 1 : 0;
    }
    printf("%d ended, %d held up; ", ended, held_up);
    CHECK(ended > 1);
    CHECK((WORDS == 2) == (held_up > 0));
}

static void never_tears_words_that_belong_together(void)
{
    for (int second = 0; second < BEHIND; second++) {
        for (int third = 0; third < BEHIND; third++) {
            start();
            set(1);
            step();
            accesses = 0;
            pending[0].at = second;
            pending[0].run = set_3;
            pending[1].at = third;
            pending[1].run = look;
            set(2);
            pending[0].at = -1;
            pending[1].at = -1;
            CHECK(told() == 2 || told() == 3);
            step();
            CHECK(!is_stale());
        }
    }
}

int main(void)
{
    for (int call = 1; call <= 4; call++) {
        start();
        set(call);
        read_words(known[call]);
    }
    shows_that_calls_cease();
    shows_a_call_that_ended_for_good();
    never_tears_words_that_belong_together();
    printf("%d failures\n", failures);
    return (failures == 0) ? 0 : 1;
}
