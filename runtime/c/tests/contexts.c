/* Bus voltage and signals shared by contexts of one core: interrupts before every access, nested
 * interrupts, and calls that never resume, which are given up after HEXAGEN_GIVEN_UP periods. Every
 * failed check prints its line; the exit code is their number. */
#include "hexagen.h"

#include <setjmp.h>
#include <stdio.h>

#define STALE 2000
/* More accesses than any scenario makes. */
#define BEHIND 40

static hexagen_bus bus;
static hexagen_port port;
static int failures;
static int accesses;
static jmp_buf killed;

/* The interrupts, each before an access, counted over all contexts; none if -1. */
static int kill_at = -1;
static struct {
    int at;
    void (*run)(void);
} pending[2] = { { -1, 0 }, { -1, 0 } };

#define CHECK(what)                                     \
    do {                                                \
        if (!(what)) {                                  \
            failures += 1;                              \
            printf("line %d: %s\n", __LINE__, #what);   \
        }                                               \
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

static void none_pend(void)
{
    accesses = 0;
    kill_at = -1;
    pending[0].at = -1;
    pending[1].at = -1;
}

/* ---- Bus voltage */

static void period(void)
{
    CHECK(hexagen_pass_period(&bus, STALE) == HEXAGEN_FAULT_NONE);
}

static bool is_stale(void)
{
    return hexagen_bus_is_stale(&bus);
}

static void start(void)
{
    hexagen_start_bus(&bus, 0, 1);
    none_pend();
}

/* The call whose words the control loop uses; -1 if they are of two calls. */
static int told(void)
{
    const volatile int32_t *const words = hexagen_bus_words(&bus);
    const int first = (int)words[0];
    return (words[1] == 1 - 10 * first) ? first : -1;
}

static void set(int call)
{
    hexagen_tell_bus(&bus, call, 1 - 10 * call, HEXAGEN_SOUND);
}

static void set_3(void)
{
    set(3);
}

static void look(void)
{
    CHECK(told() >= 0);
    period();
}

static void shows_that_calls_cease(void)
{
    start();
    CHECK(is_stale());
    period();
    CHECK(is_stale());
    for (int again = 0; again < 2; again++) {
        set(2);
        for (int n = 0; n < STALE; n++) {
            period();
            CHECK(!is_stale());
        }
        for (int n = 0; n < 3 * STALE; n++) {
            period();
            CHECK(is_stale());
        }
    }
}

static void passes_a_fault_on_once(void)
{
    start();
    set(2);
    hexagen_tell_bus(&bus, 3, -29, (int32_t)HEXAGEN_FAULT_OVER_VOLTAGE);
    CHECK(hexagen_pass_period(&bus, STALE) == HEXAGEN_FAULT_OVER_VOLTAGE);
    CHECK(!is_stale() && told() == 3);
    period();
    hexagen_tell_bus(&bus, 3, -29, (int32_t)HEXAGEN_FAULT_UNDER_VOLTAGE);
    set(2);
    period();
}

/* Abandons a call before an access; false if the call has no such access. */
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
        period();
        if (!kill_a_call(access)) {
            continue;
        }
        ended += 1;
        CHECK(told() == 2 || told() == 3);
        long held = 0;
        long stale = 0;
        for (long n = 0; n < 2L * HEXAGEN_GIVEN_UP; n++) {
            set(4);
            period();
            held += (told() != 4) ? 1 : 0;
            stale += is_stale() ? 1 : 0;
            CHECK(told() >= 0);
            CHECK(told() != 4 || !is_stale());
        }
        CHECK(told() == 4 && !is_stale());
        CHECK(held == 0 || held == HEXAGEN_GIVEN_UP);
        CHECK(held == 0 || stale >= held - STALE);
        held_up += (stale > 0) ? 1 : 0;
    }
    printf("%d ended, %d held up; ", ended, held_up);
    CHECK(ended > 6 && held_up > 3);
}

static void never_tears_words_that_belong_together(void)
{
    for (int second = 0; second < BEHIND; second++) {
        for (int third = 0; third < BEHIND; third++) {
            start();
            set(1);
            period();
            accesses = 0;
            pending[0].at = second;
            pending[0].run = set_3;
            pending[1].at = third;
            pending[1].run = look;
            set(2);
            pending[0].at = -1;
            pending[1].at = -1;
            CHECK(told() == 2 || told() == 3);
            period();
            CHECK(!is_stale());
        }
    }
}

/* ---- Signals */

static int32_t now;

/* A controlled period, whose words all contain its number. */
static void answer(void)
{
    const hexagen_checked checked = { now, -2 * now, now % 6 + 1, 0, 0 };
    const hexagen_legs legs = { { (uint16_t)now, 0, (uint16_t)now },
        { HEXAGEN_LEG_PULSED, HEXAGEN_LEG_OFF, HEXAGEN_LEG_LOW } };
    const hexagen_observation observation = { now, now, -now };
    if (hexagen_is_asked(&port)) {
        hexagen_answer(&port, checked, legs, observation);
    }
    now += 1;
}

static void two_periods(void)
{
    answer();
    answer();
}

static const hexagen_units units = { { 4, 1 }, { 4, 1 }, { 4, 1 }, { 4, 1 },
    { 0, 1, 2, 3, 4, 5, 6, 0 } };

/* a high, then a against c, then a and c low with b off; 0 high, 1 low, 2 off. */
static void intervals_are_shown_as_legs(void)
{
    const hexagen_intervals intervals = { { 300, 700 }, { 36, 24, 25 } };
    const hexagen_legs legs = hexagen_legs_of(intervals);
    const hexagen_legs off = hexagen_legs_of(hexagen_all_intervals(HEXAGEN_LEG_OFF));
    CHECK(hexagen_leg_in(intervals, 0, 0) == HEXAGEN_LEG_PULSED);
    CHECK(hexagen_leg_in(intervals, 0, 1) == HEXAGEN_LEG_LOW);
    CHECK(hexagen_leg_in(intervals, 1, 1) == HEXAGEN_LEG_OFF);
    CHECK(legs.compare[0] == 700 && legs.compare[1] == 0 && legs.compare[2] == 0);
    CHECK(legs.state[0] == HEXAGEN_LEG_PULSED && legs.state[1] == HEXAGEN_LEG_PULSED);
    CHECK(legs.state[2] == HEXAGEN_LEG_PULSED);
    CHECK(off.state[0] == HEXAGEN_LEG_OFF && off.state[1] == HEXAGEN_LEG_OFF);
    CHECK(off.state[2] == HEXAGEN_LEG_OFF);
}

static void signals_are_of_one_period(void)
{
    int found = 0;
    for (int strike = 0; strike < BEHIND; strike++) {
        hexagen_signals signals;
        int32_t asked;
        hexagen_start_port(&port);
        none_pend();
        answer();
        asked = now;
        CHECK(!hexagen_take(&port, &units, &signals));
        answer();
        for (int again = 0; again < 4; again++) {
            bool is_there;
            accesses = 0;
            pending[0].at = strike;
            pending[0].run = two_periods;
            is_there = hexagen_take(&port, &units, &signals);
            pending[0].at = -1;
            if (is_there) {
                const int32_t of = signals.currents[0] / 2;
                found += 1;
                CHECK(!hexagen_is_asked(&port));
                CHECK(of >= asked && of < now);
                CHECK(signals.currents[1] == -4 * of && signals.currents[2] == 2 * of);
                CHECK(signals.sector == of % 6 + 1);
                CHECK(signals.voltages[0] == 2 * of && signals.voltages[2] == 0);
                CHECK(!signals.is_off[0] && signals.is_off[1] && !signals.is_off[2]);
                CHECK(signals.has_emf && signals.emf[0] == 2 * of && signals.emf[2] == -4 * of);
                CHECK(signals.has_speed && signals.speed == -2 * of);
                asked = now;
            }
            answer();
        }
    }
    CHECK(found >= 2 * BEHIND);
}

static void no_answer_is_lost(void)
{
    int struck = 0;
    for (int strike = 0; strike < BEHIND; strike++) {
        hexagen_signals signals;
        bool is_there;
        hexagen_start_port(&port);
        none_pend();
        CHECK(!hexagen_take(&port, &units, &signals));
        accesses = 0;
        pending[0].at = strike;
        pending[0].run = two_periods;
        is_there = hexagen_take(&port, &units, &signals);
        if (pending[0].at == -1) {
            struck += 1;
            CHECK(is_there || hexagen_take(&port, &units, &signals));
        }
    }
    CHECK(struck > 0);
}

static int taken;

/* A request from a context that interrupts another request takes the answer, and the next one. */
static void take_too(void)
{
    hexagen_signals signals;
    taken += hexagen_take(&port, &units, &signals) ? 1 : 0;
    taken += hexagen_take(&port, &units, &signals) ? 1 : 0;
    answer();
}

static void who_asks_is_not_torn_by_another_who_asks(void)
{
    for (int strike = 0; strike < BEHIND; strike++) {
        hexagen_signals signals;
        bool is_there;
        hexagen_start_port(&port);
        none_pend();
        CHECK(!hexagen_take(&port, &units, &signals));
        answer();
        taken = 0;
        accesses = 0;
        pending[0].at = strike;
        pending[0].run = take_too;
        is_there = hexagen_take(&port, &units, &signals);
        CHECK(is_there || taken > 0);
        if (is_there) {
            const int32_t of = signals.currents[0] / 2;
            CHECK(signals.currents[1] == -4 * of && signals.emf[2] == -4 * of);
        }
    }
}

int main(void)
{
    shows_that_calls_cease();
    passes_a_fault_on_once();
    shows_a_call_that_ended_for_good();
    never_tears_words_that_belong_together();
    intervals_are_shown_as_legs();
    signals_are_of_one_period();
    no_answer_is_lost();
    who_asks_is_not_torn_by_another_who_asks();
    printf("%d failures\n", failures);
    return (failures == 0) ? 0 : 1;
}
