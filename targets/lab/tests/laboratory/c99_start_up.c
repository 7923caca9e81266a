/*
 * Start-up of a drive with 16 samples of calibration and 4 periods of pre-charge, as firmware calls
 * it.
 */
#include "hub.h"
#include <stdio.h>

static hub drive;

#define EXPECT(what)                                    \
    do {                                                \
        if (!(what)) {                                  \
            printf("line %d: %s\n", __LINE__, #what);   \
            return 1;                                   \
        }                                               \
    } while (0)

/* Steps with all legs in a state, until the first other one. */
static int steps(int count, hexagen_mode mode, hexagen_leg leg, uint16_t adc_a, uint16_t adc_b)
{
    int done;
    for (done = 0; done < count; done++) {
        const hexagen_mode before = hub_status(&drive).mode;
        const hexagen_sample sample = hexagen_with_hall(adc_a, adc_b, 5);
        const hexagen_legs legs = hub_step(&drive, &sample);
        if (before != mode || legs.state[0] != leg || legs.state[1] != leg || legs.state[2] != leg) {
            break;
        }
    }
    return done;
}

/* Whether these counts are the offsets; `unit` is one count. */
static int32_t unit;

static int has_offsets(int32_t adc_a, int32_t adc_b)
{
    return drive.supervisor.offset[0] == adc_a * unit && drive.supervisor.offset[1] == adc_b * unit;
}

/* A start with a rotor that stands, which takes as long as each other one. */
static int starts(void)
{
    static int periods;
    const int done = steps(10000, HEXAGEN_MODE_START, HEXAGEN_LEG_OFF, 2040, 2050);
    periods = (periods == 0) ? done : periods;
    return done > 1 && done == periods;
}

/* A whole start-up with these offsets: the samples of pre-charge and control are others. */
static int starts_up(uint16_t adc_a, uint16_t adc_b)
{
    return steps(16, HEXAGEN_MODE_CALIBRATE, HEXAGEN_LEG_OFF, adc_a, adc_b) == 16 && has_offsets(adc_a, adc_b)
        && steps(4, HEXAGEN_MODE_PRECHARGE, HEXAGEN_LEG_LOW, 2030, 2060) == 4 && has_offsets(adc_a, adc_b)
        && starts() && has_offsets(adc_a, adc_b)
        && steps(40, HEXAGEN_MODE_RUN, HEXAGEN_LEG_PULSED, 2040, 2050) == 40 && has_offsets(adc_a, adc_b);
}

static bool is_running(void)
{
    return hub_status(&drive).mode == HEXAGEN_MODE_RUN;
}

/* Whether a copy of the supervisor has each of its words: all are unlike, within their types. */
static int is_kept_whole(void)
{
    hexagen_supervisor whole;
    volatile hexagen_supervisor kept;
    hexagen_supervisor copy;
    int32_t words[HEXAGEN_WORDS];
    int32_t told[HEXAGEN_WORDS];
    int word;
    for (word = 0; word < HEXAGEN_WORDS; word++) {
        words[word] = 0;
    }
    hexagen_set_words(&whole, words);
    hexagen_keep(&kept, &whole);
    for (word = 0; word < HEXAGEN_WORDS; word++) {
        words[word] = word + 1;
    }
    hexagen_set_words(&whole, words);
    hexagen_keep(&kept, &whole);
    copy = kept;
    hexagen_words(&copy, told);
    for (word = 0; word < HEXAGEN_WORDS; word++) {
        if (told[word] != words[word]) {
            return 0;
        }
    }
    return 1;
}

int main(void)
{
    const hexagen_sample without_code = hexagen_with_hall(2058, 2028, 0);
    hexagen_signals signals;
    hub_trip_record record;
    EXPECT(is_kept_whole());
    hub_init(&drive);
    unit = drive.supervisor.offset[0] / 2048;
    EXPECT(has_offsets(2048, 2048));
    EXPECT(hub_status(&drive).mode == HEXAGEN_MODE_START && starts() && is_running());
    hub_calibrate(&drive);
    EXPECT(hub_status(&drive).mode == HEXAGEN_MODE_CALIBRATE);
    EXPECT(!is_running());
    EXPECT(starts_up(2148, 1998));

    /* Again, from control. */
    hub_calibrate(&drive);
    EXPECT(starts_up(1948, 2098));

    /* Again, halfway: the first half is discarded. */
    hub_calibrate(&drive);
    EXPECT(steps(8, HEXAGEN_MODE_CALIBRATE, HEXAGEN_LEG_OFF, 2148, 1948) == 8);
    hub_calibrate(&drive);
    EXPECT(starts_up(2068, 2008));

    /* Again, in pre-charge. */
    hub_calibrate(&drive);
    EXPECT(steps(16, HEXAGEN_MODE_CALIBRATE, HEXAGEN_LEG_OFF, 2148, 1948) == 16);
    EXPECT(steps(2, HEXAGEN_MODE_PRECHARGE, HEXAGEN_LEG_LOW, 2148, 1948) == 2);
    hub_calibrate(&drive);
    EXPECT(hub_status(&drive).mode == HEXAGEN_MODE_CALIBRATE);
    EXPECT(starts_up(2048, 2028));

    /* A trip, which only reset ends; offsets are kept. */
    EXPECT(!hub_trip(&drive, &record));
    (void)hub_step(&drive, &without_code);
    EXPECT(hub_status(&drive).mode == HEXAGEN_MODE_TRIPPED && hub_status(&drive).fault == HEXAGEN_FAULT_HALL);
    hub_calibrate(&drive);
    hub_precharge(&drive);
    EXPECT(hub_status(&drive).mode == HEXAGEN_MODE_TRIPPED);

    /* The period of the trip is kept whatever comes behind it: the law's words are those before it. */
    EXPECT(steps(4, HEXAGEN_MODE_TRIPPED, HEXAGEN_LEG_OFF, 2048, 2028) == 4);
    EXPECT(hub_trip(&drive, &record) && record.sample.hall == 0 && record.sample.adc[0] == 2058);
    EXPECT(record.supervisor.fault == HEXAGEN_FAULT_HALL && record.supervisor.offset[1] == 2028 * unit);
    EXPECT(record.current == 0 && record.state.i_a_prev == -8 * unit);
    hub_set_current_ma(&drive, 5000);
    EXPECT(drive.current > 0);
    hub_reset(&drive);
    EXPECT(drive.current == 0 && !hub_trip(&drive, &record));
    EXPECT(!is_running() && hub_status(&drive).fault == HEXAGEN_FAULT_NONE);
    EXPECT(starts() && is_running());
    EXPECT(steps(40, HEXAGEN_MODE_RUN, HEXAGEN_LEG_PULSED, 2048, 2028) == 40 && has_offsets(2048, 2028));
    hub_precharge(&drive);
    EXPECT(hub_status(&drive).mode == HEXAGEN_MODE_PRECHARGE);
    EXPECT(steps(4, HEXAGEN_MODE_PRECHARGE, HEXAGEN_LEG_LOW, 2048, 2028) == 4);
    EXPECT(starts() && is_running());

    /* Off on purpose, without a fault; then a rotor that stands is shorted as soon as it is known to. */
    hub_coast(&drive);
    EXPECT(steps(40, HEXAGEN_MODE_COAST, HEXAGEN_LEG_OFF, 2048, 2028) == 40);
    EXPECT(hub_status(&drive).fault == HEXAGEN_FAULT_NONE);
    hub_brake(&drive);
    hub_set_current_ma(&drive, 5000);
    (void)steps(1000, HEXAGEN_MODE_BRAKE, HEXAGEN_LEG_PULSED, 2048, 2028);
    EXPECT(steps(40, HEXAGEN_MODE_BRAKE, HEXAGEN_LEG_LOW, 2048, 2028) == 40);
    hub_resume(&drive);
    EXPECT(is_running() && drive.current == 0);
    EXPECT(steps(40, HEXAGEN_MODE_RUN, HEXAGEN_LEG_PULSED, 2048, 2028) == 40);

    /* Signals are of the next controlled period, in which legs of 24 V make no current. */
    EXPECT(!hub_signals(&drive, &signals) && !hub_signals(&drive, &signals));
    EXPECT(steps(1, HEXAGEN_MODE_RUN, HEXAGEN_LEG_PULSED, 2048, 2028) == 1);
    EXPECT(hub_signals(&drive, &signals) && !hub_signals(&drive, &signals));
    EXPECT(signals.currents[0] == 0 && signals.currents[2] == 0 && signals.sector == 2);
    EXPECT(!signals.is_off[0]);
    EXPECT(signals.voltages[0] > 23 * 65536 && signals.voltages[0] < 25 * 65536);
    printf("passed\n");
    return 0;
}
