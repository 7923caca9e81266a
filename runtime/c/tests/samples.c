/* Every ADC count through the supervisor, at both ends of the offset, compared with a 64-bit
 * supervisor: samples passed, cause of each trip, and range of the currents. */
#include "hexagen.h"

#include <stdio.h>

HEXAGEN_LIMITS(rising, 4095, false, 18, 2048, 1946, 2150, INT32_C(509607936),
    -INT32_C(2150) * 262144, (INT32_C(4095) - 1946) * 262144, 8, 20, 0, 0, 0,
    0x04236510, 5, 0, 0, 65535);
HEXAGEN_LIMITS(falling, 4095, true, 18, 2048, 1946, 2150, INT32_C(400000001),
    (INT32_C(1946) - 4095) * 262144, INT32_C(2150) * 262144, 0, 0, 5, 0, 0,
    0x04236510, 0, 0, 0, 65535);
HEXAGEN_LIMITS(coarse, 1023, false, 0, 512, 0, 1023, 400, -INT32_C(1023), 1023, 15, 0, 0, 0, 0,
    0x04236510, 7, 0, 0, 65535);
HEXAGEN_LIMITS(wide, 65535, false, 14, 32768, 32000, 33000, INT32_C(500000000),
    -INT32_C(33000) * 16384, (INT32_C(65535) - 32000) * 16384, 4, 3, 7, 0, 0,
    0x04236510, 7, 0, 0, 65535);
/* Sensors 60 degrees apart, up to two samples bridged, a bus of 1000 to 3000 counts. */
HEXAGEN_LIMITS(bridging, 4095, false, 18, 2048, 1946, 2150, INT32_C(509607936),
    -INT32_C(2150) * 262144, (INT32_C(4095) - 1946) * 262144, 8, 20, 0, 2, 2, 0x04236510, 5, 0, 1000,
    3000);
HEXAGEN_LIMITS_OF(of_b_and_c, 4095, false, 18, 2048, 1946, 2150, INT32_C(400000001),
    -INT32_C(2150) * 262144, (INT32_C(4095) - 1946) * 262144, 8, 20, 0, 0, 0, 0x04236510, 5, 0, 0, 65535,
    HEXAGEN_SENSED_BC, false, 2048, 1946, 2150, HEXAGEN_ALIKE);
HEXAGEN_LIMITS_OF(of_c_and_a, 4095, false, 10, 2048, 1946, 2150, INT32_C(2000000),
    -INT32_C(2195) * 1024, INT32_C(2202) * 1024, 8, 20, 0, 0, 0, 0x04236510, 5, 0, 0, 65535,
    HEXAGEN_SENSED_CA, true, 2000, 1900, 2202, HEXAGEN_ALIKE);
HEXAGEN_LIMITS(loose, 4095, true, 3, 3000, 0, 4095, INT32_C(2147483647), -INT32_C(4095) * 8,
    INT32_C(4095) * 8, 8, 1, 0, 0, 0, 0x04236510, 7, 0, 0, 65535);

/* A trip level within the tolerance of the offsets. */
HEXAGEN_LIMITS(close, 4095, false, 18, 2048, 1946, 2150, INT32_C(50) * 262144,
    -INT32_C(2150) * 262144, (INT32_C(4095) - 1946) * 262144, 4, 20, 0, 0, 0, 0x04236510, 5, 0, 0,
    65535);

/* A start of at most nine periods. */
HEXAGEN_LIMITS(starting, 4095, false, 18, 2048, 1946, 2150, INT32_C(509607936),
    -INT32_C(2150) * 262144, (INT32_C(4095) - 1946) * 262144, 2, 0, 0, 0, 0, 0x04236510, 5, 9, 0,
    65535);

static const hexagen_limits *const all[] = { &rising, &falling, &coarse, &wide, &of_b_and_c,
    &of_c_and_a, &loose };

static unsigned long passed;
static unsigned long tripped[8];

static int64_t size(int64_t x)
{
    return (x < 0) ? -x : x;
}

static int64_t current(const hexagen_limits *limits, int sensor, int64_t count, int64_t offset)
{
    const int64_t word = (count - offset) * (INT64_C(1) << limits->current_bits);
    return limits->sensors[sensor].inverted ? -word : word;
}

/* Phases of the sensors, 0 to 2. */
static const int phases[3][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 } };

static hexagen_fault fault_of(const hexagen_limits *limits, const hexagen_sample *sample,
    hexagen_mode mode, int64_t i_a, int64_t i_b)
{
    const int *const places = phases[limits->sensed];
    const uint16_t a = sample->adc[places[0]], b = sample->adc[places[1]];
    const int64_t trip = limits->trip;
    if (a == 0 || b == 0 || a >= limits->adc_max || b >= limits->adc_max) {
        return HEXAGEN_FAULT_ADC_RANGE;
    }
    if (sample->hall == 0 || sample->hall > 6) {
        return HEXAGEN_FAULT_HALL;
    }
    if (mode != HEXAGEN_MODE_CALIBRATE
        && (size(i_a) > trip || size(i_b) > trip || size(i_a + i_b) > trip)) {
        return HEXAGEN_FAULT_OVER_CURRENT;
    }
    return HEXAGEN_FAULT_NONE;
}

#define EXPECT(what)                                                                         \
    do {                                                                                     \
        if (!(what)) {                                                                       \
            printf("line %d: %s: counts %u, %u, code %u, offsets %u, %u\n", __LINE__, #what, \
                (unsigned)sample.adc[0], (unsigned)sample.adc[1], (unsigned)sample.hall,     \
                (unsigned)offset_a, (unsigned)offset_b);                                     \
            return 1;                                                                        \
        }                                                                                    \
    } while (0)

static int try(const hexagen_limits *limits, hexagen_sample sample, uint16_t offset_a,
    uint16_t offset_b, hexagen_mode mode)
{
    const volatile int32_t set_point = 1;
    const uint16_t most = limits->adc_max;
    const int *const places = phases[limits->sensed];
    const uint16_t counts[2] = { sample.adc[places[0]], sample.adc[places[1]] };
    const int64_t first = current(limits, 0, counts[0], offset_a);
    const int64_t second = current(limits, 1, counts[1], offset_b);
    const hexagen_fault fault = fault_of(limits, &sample, mode, first, second);
    int64_t i[3];
    hexagen_supervisor supervisor;
    hexagen_checked checked;
    bool passes;
    hexagen_start(&supervisor, limits);
    supervisor.mode = mode;
    supervisor.countdown = 2;
    supervisor.offset[0] = (int32_t)(offset_a * (INT64_C(1) << limits->current_bits));
    supervisor.offset[1] = (int32_t)(offset_b * (INT64_C(1) << limits->current_bits));
    passes = hexagen_check(&supervisor, limits, &sample, &set_point, &checked);
    EXPECT(passes == (mode == HEXAGEN_MODE_RUN && fault == HEXAGEN_FAULT_NONE));
    if (passes) {
        passed += 1;
        i[places[0]] = first;
        i[places[1]] = second;
        i[3 - places[0] - places[1]] = -(first + second);
        EXPECT(checked.i_a == i[0] && checked.i_b == i[1] && checked.hall == sample.hall);
    } else {
        const uint16_t a = (counts[0] < most) ? counts[0] : most;
        const uint16_t b = (counts[1] < most) ? counts[1] : most;
        const int64_t low = limits->current_least, high = limits->current_most;
        int64_t third;
        const hexagen_unfit unfit
            = hexagen_examine(&supervisor, limits, &sample, HEXAGEN_FAULT_NONE, &checked);
        const hexagen_leg leg = hexagen_rest(&supervisor, limits, &sample, unfit.fault);
        const bool charges = mode == HEXAGEN_MODE_PRECHARGE && fault == HEXAGEN_FAULT_NONE;
        i[places[0]] = current(limits, 0, a, offset_a);
        i[places[1]] = current(limits, 1, b, offset_b);
        third = -(i[places[0]] + i[places[1]]);
        i[3 - places[0] - places[1]] = (third < low) ? low : (third > high) ? high : third;
        EXPECT(checked.i_a == i[0]);
        EXPECT(checked.i_b == i[1]);
        EXPECT(checked.hall == ((sample.hall >= 1 && sample.hall <= 6) ? sample.hall : 0));
        EXPECT(!unfit.is_controlled && unfit.fault == fault);
        EXPECT(leg == (charges ? HEXAGEN_LEG_LOW : HEXAGEN_LEG_OFF));
        EXPECT(supervisor.fault == ((mode == HEXAGEN_MODE_TRIPPED) ? HEXAGEN_FAULT_NONE : fault));
        EXPECT((supervisor.mode == HEXAGEN_MODE_TRIPPED)
            == (mode == HEXAGEN_MODE_TRIPPED || fault != HEXAGEN_FAULT_NONE));
        tripped[fault] += 1;
    }
    EXPECT(limits->current_least <= checked.i_a && checked.i_a <= limits->current_most);
    EXPECT(limits->current_least <= checked.i_b && checked.i_b <= limits->current_most);
    return 0;
}

#define STATES(what)                                      \
    do {                                                  \
        if (!(what)) {                                    \
            printf("line %d: %s\n", __LINE__, #what);     \
            return 1;                                     \
        }                                                 \
    } while (0)

/* A drive that rests or brakes: what so many periods with a Hall code come to. */
static int rests(hexagen_supervisor *supervisor, const hexagen_limits *limits, uint16_t hall,
    unsigned periods, hexagen_leg leg, bool is_controlled, int32_t against)
{
    const volatile int32_t set_point = 1;
    const hexagen_sample sample = hexagen_with_hall(2048, 2048, hall);
    for (unsigned period = 0; period < periods; period++) {
        hexagen_checked checked;
        hexagen_unfit unfit;
        STATES(!hexagen_check(supervisor, limits, &sample, &set_point, &checked));
        unfit = hexagen_examine(supervisor, limits, &sample, HEXAGEN_FAULT_NONE, &checked);
        STATES(unfit.is_controlled == is_controlled && unfit.against == against);
        if (!is_controlled) {
            STATES(hexagen_rest(supervisor, limits, &sample, unfit.fault) == leg);
        }
    }
    return 0;
}

/* A start whose codes, 0 at their end, are followed by control, and not before. */
static int starts(const uint16_t *codes)
{
    hexagen_supervisor supervisor;
    hexagen_start(&supervisor, &starting);
    for (; *codes != 0U; codes++) {
        STATES(supervisor.mode == HEXAGEN_MODE_START);
        STATES(rests(&supervisor, &starting, *codes, 1, HEXAGEN_LEG_OFF, false, 0) == 0);
    }
    STATES(supervisor.mode == HEXAGEN_MODE_RUN);
    return 0;
}

/* A start ends behind two edges in one direction, or so many periods. */
static int waits(void)
{
    static const uint16_t ends[][10] = { { 1, 1, 1, 1, 1, 1, 1, 1, 1, 0 }, { 1, 1, 5, 5, 4, 0 },
        { 1, 3, 2, 0 }, { 1, 5, 1, 3, 0 }, { 1, 6, 2, 3, 0 },
        { 1, 5, 6, 2, 3, 0 }, { 1, 5, 1, 5, 1, 5, 1, 5, 1, 0 } };
    hexagen_supervisor supervisor;
    for (unsigned place = 0; place < sizeof ends / sizeof ends[0]; place++) {
        STATES(starts(ends[place]) == 0);
    }
    /* Braking and coasting go on with it: legs are off until it is over. */
    hexagen_start(&supervisor, &starting);
    STATES(rests(&supervisor, &starting, 1, 2, HEXAGEN_LEG_OFF, false, 0) == 0);
    hexagen_coast(&supervisor);
    STATES(rests(&supervisor, &starting, 5, 2, HEXAGEN_LEG_OFF, false, 0) == 0);
    hexagen_brake(&supervisor);
    STATES(rests(&supervisor, &starting, 5, 1, HEXAGEN_LEG_OFF, false, 0) == 0);
    STATES(rests(&supervisor, &starting, 4, 2, HEXAGEN_LEG_OFF, true, 1) == 0);
    STATES(hexagen_resume(&supervisor) && supervisor.mode == HEXAGEN_MODE_RUN);
    /* A start that is interrupted goes on; calibration and a reset come before one. */
    hexagen_start(&supervisor, &starting);
    hexagen_coast(&supervisor);
    STATES(hexagen_resume(&supervisor) && supervisor.mode == HEXAGEN_MODE_START);
    hexagen_calibrate(&supervisor, &starting);
    STATES(rests(&supervisor, &starting, 1, 4, HEXAGEN_LEG_OFF, false, 0) == 0);
    STATES(supervisor.mode == HEXAGEN_MODE_START && supervisor.countdown == 9);
    STATES(rests(&supervisor, &starting, 1, 9, HEXAGEN_LEG_OFF, false, 0) == 0);
    STATES(supervisor.mode == HEXAGEN_MODE_RUN);
    STATES(hexagen_reset(&supervisor, &starting) && supervisor.mode == HEXAGEN_MODE_START);
    return 0;
}

/* Sectors of at least five periods are shorted; shorter ones ask for torque against the rotation. */
static int brakes(void)
{
    hexagen_supervisor supervisor;
    hexagen_start(&supervisor, all[0]);
    hexagen_coast(&supervisor);
    STATES(supervisor.mode == HEXAGEN_MODE_COAST);
    STATES(rests(&supervisor, all[0], 5, 9, HEXAGEN_LEG_OFF, false, 0) == 0);
    STATES(hexagen_resume(&supervisor) && supervisor.mode == HEXAGEN_MODE_RUN);
    STATES(!hexagen_resume(&supervisor));
    hexagen_brake(&supervisor);
    STATES(rests(&supervisor, all[0], 1, 4, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 1, 3, HEXAGEN_LEG_LOW, false, 0) == 0);
    STATES(rests(&supervisor, all[0], 5, 3, HEXAGEN_LEG_LOW, false, 0) == 0);
    STATES(rests(&supervisor, all[0], 4, 3, HEXAGEN_LEG_LOW, false, 0) == 0);
    STATES(rests(&supervisor, all[0], 6, 2, HEXAGEN_LEG_OFF, true, 1) == 0);
    STATES(rests(&supervisor, all[0], 3, 2, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 2, 4, HEXAGEN_LEG_OFF, true, 0) == 0);
    hexagen_brake(&supervisor);
    STATES(rests(&supervisor, all[0], 6, 4, HEXAGEN_LEG_OFF, true, -1) == 0);
    STATES(rests(&supervisor, all[0], 6, 2, HEXAGEN_LEG_LOW, false, 0) == 0);
    STATES(rests(&supervisor, all[0], 0, 1, HEXAGEN_LEG_OFF, false, 0) == 0);
    STATES(supervisor.fault == HEXAGEN_FAULT_HALL);
    hexagen_coast(&supervisor);
    hexagen_brake(&supervisor);
    STATES(!hexagen_resume(&supervisor) && supervisor.mode == HEXAGEN_MODE_TRIPPED);
    STATES(hexagen_reset(&supervisor, all[0]) && supervisor.turn_direction == 0);
    return 0;
}

/*
 * A rotor that stands stays shorted whatever one sensor does: edges there and back are no motion. Two
 * edges in one direction are.
 */
static int chatters(void)
{
    hexagen_supervisor supervisor;
    hexagen_start(&supervisor, all[0]);
    hexagen_brake(&supervisor);
    /* From the first period on. */
    STATES(rests(&supervisor, all[0], 4, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 6, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 4, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 6, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 4, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    for (unsigned time = 0; time < 9; time++) {
        STATES(rests(&supervisor, all[0], 6, 1 + time % 3, HEXAGEN_LEG_LOW, false, 0) == 0);
        STATES(rests(&supervisor, all[0], 4, 1 + time % 2, HEXAGEN_LEG_LOW, false, 0) == 0);
    }
    STATES(rests(&supervisor, all[0], 4, 9, HEXAGEN_LEG_LOW, false, 0) == 0);
    STATES(rests(&supervisor, all[0], 5, 1, HEXAGEN_LEG_LOW, false, 0) == 0);
    STATES(rests(&supervisor, all[0], 4, 9, HEXAGEN_LEG_LOW, false, 0) == 0);
    /* It turns, one sample is disturbed, and it stops in the middle of braking torque. */
    STATES(rests(&supervisor, all[0], 6, 3, HEXAGEN_LEG_LOW, false, 0) == 0);
    STATES(rests(&supervisor, all[0], 2, 4, HEXAGEN_LEG_OFF, true, 1) == 0);
    STATES(rests(&supervisor, all[0], 3, 2, HEXAGEN_LEG_OFF, true, 1) == 0);
    STATES(rests(&supervisor, all[0], 2, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 3, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 1, 2, HEXAGEN_LEG_OFF, true, 1) == 0);
    STATES(supervisor.turn_interval == 4);
    STATES(rests(&supervisor, all[0], 3, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 1, 1, HEXAGEN_LEG_OFF, true, 0) == 0);
    STATES(rests(&supervisor, all[0], 3, 9, HEXAGEN_LEG_LOW, false, 0) == 0);
    return 0;
}

/* What a calibration with these counts ends in; a trip level of 50 counts, a tolerance of 102. */
static hexagen_fault calibrates(uint16_t count_a, uint16_t count_b)
{
    const volatile int32_t set_point = 0;
    const hexagen_sample sample = hexagen_with_hall(count_a, count_b, 5);
    hexagen_supervisor supervisor;
    hexagen_start(&supervisor, &close);
    hexagen_calibrate(&supervisor, &close);
    for (unsigned period = 0; period < 17; period++) {
        hexagen_checked checked;
        if (!hexagen_check(&supervisor, &close, &sample, &set_point, &checked)) {
            const hexagen_unfit unfit
                = hexagen_examine(&supervisor, &close, &sample, HEXAGEN_FAULT_NONE, &checked);
            (void)hexagen_rest(&supervisor, &close, &sample, unfit.fault);
        }
    }
    return supervisor.fault;
}

/* Offsets are judged as offsets, not as currents by the nominal ones. */
static int judges_offsets(void)
{
    hexagen_supervisor supervisor;
    STATES(calibrates(2150, 2150) == HEXAGEN_FAULT_NONE);
    STATES(calibrates(1946, 2150) == HEXAGEN_FAULT_NONE);
    STATES(calibrates(2048, 1946) == HEXAGEN_FAULT_NONE);
    STATES(calibrates(2151, 2048) == HEXAGEN_FAULT_OFFSET);
    STATES(calibrates(2048, 1945) == HEXAGEN_FAULT_OFFSET);
    STATES(calibrates(1, 4094) == HEXAGEN_FAULT_OFFSET);
    STATES(calibrates(0, 2048) == HEXAGEN_FAULT_ADC_RANGE);
    STATES(calibrates(2048, 4095) == HEXAGEN_FAULT_ADC_RANGE);
    /* Currents, by the measured offsets, from the next period on. */
    hexagen_start(&supervisor, &close);
    hexagen_calibrate(&supervisor, &close);
    STATES(rests(&supervisor, &close, 5, 16, HEXAGEN_LEG_OFF, false, 0) == 0);
    supervisor.offset[0] = hexagen_shift_left(2150, 18);
    STATES(rests(&supervisor, &close, 5, 1, HEXAGEN_LEG_OFF, false, 0) == 0);
    STATES(supervisor.fault == HEXAGEN_FAULT_OVER_CURRENT);
    return 0;
}

/* The code that a period of control takes; -1 for a trip. */
static int follows(hexagen_supervisor *supervisor, const hexagen_limits *limits, uint16_t hall)
{
    const volatile int32_t set_point = 0;
    const hexagen_sample sample = hexagen_with_hall(2048, 2048, hall);
    hexagen_checked checked;
    if (!hexagen_check(supervisor, limits, &sample, &set_point, &checked)) {
        const hexagen_unfit unfit
            = hexagen_examine(supervisor, limits, &sample, HEXAGEN_FAULT_NONE, &checked);
        if (!unfit.is_controlled) {
            (void)hexagen_rest(supervisor, limits, &sample, unfit.fault);
            return -1;
        }
    }
    return checked.hall;
}

/* Codes 2, 3, 1, 5, 4, 6 are sampled as 0, 1, 3, 7, 6, 4; up to two disturbed ones are bridged. */
static int bridges(void)
{
    static const uint16_t sampled[] = { 0, 1, 3, 2, 5, 7, 0, 6, 6, 4, 9, 3, 5 };
    static const int taken[] = { 2, 3, 1, 1, 1, 5, 5, 4, 4, 6, 6, 6, -1 };
    hexagen_supervisor supervisor;
    hexagen_status status;
    hexagen_start(&supervisor, &bridging);
    for (unsigned sample = 0; sample < sizeof taken / sizeof taken[0]; sample++) {
        STATES(follows(&supervisor, &bridging, sampled[sample]) == taken[sample]);
    }
    status = hexagen_status_of(hexagen_status_word(&supervisor), false);
    STATES(status.mode == HEXAGEN_MODE_TRIPPED && status.fault == HEXAGEN_FAULT_HALL);
    STATES(status.hall_glitches == 5);
    STATES(hexagen_reset(&supervisor, &bridging) && supervisor.hall_glitches == 0);
    STATES(follows(&supervisor, &bridging, 2) == -1);
    STATES(hexagen_reset(&supervisor, &bridging));
    supervisor.hall_prev = 1;
    supervisor.hall_glitches = 32766;
    STATES(follows(&supervisor, &bridging, 2) == 1 && follows(&supervisor, &bridging, 2) == 1);
    status = hexagen_status_of(hexagen_status_word(&supervisor), false);
    STATES(status.hall_glitches == 32767 && status.fault == HEXAGEN_FAULT_NONE);
    return 0;
}

/* A fault that no sample shows comes before what this one shows. */
static int knows(hexagen_supervisor *supervisor, hexagen_fault known)
{
    const hexagen_sample sample = hexagen_with_hall(2048, 2048, 9);
    hexagen_checked checked;
    const hexagen_unfit unfit
        = hexagen_examine(supervisor, &bridging, &sample, known, &checked);
    STATES(!unfit.is_controlled && unfit.fault == known);
    STATES(hexagen_rest(supervisor, &bridging, &sample, known) == HEXAGEN_LEG_OFF);
    return 0;
}

static int judges_the_bus(void)
{
    hexagen_supervisor supervisor;
    STATES(hexagen_judge_bus(&bridging, 1000) == HEXAGEN_SOUND);
    STATES(hexagen_judge_bus(&bridging, 3000) == HEXAGEN_SOUND);
    STATES(hexagen_judge_bus(&bridging, 999) == (int32_t)HEXAGEN_FAULT_UNDER_VOLTAGE);
    STATES(hexagen_judge_bus(&bridging, 3001) == (int32_t)HEXAGEN_FAULT_OVER_VOLTAGE);
    STATES(hexagen_judge_bus(&rising, 0) == HEXAGEN_SOUND);
    STATES(hexagen_judge_bus(&rising, 65535) == HEXAGEN_SOUND);
    hexagen_start(&supervisor, &bridging);
    STATES(knows(&supervisor, HEXAGEN_FAULT_OVER_VOLTAGE) == 0);
    STATES(knows(&supervisor, HEXAGEN_FAULT_UNDER_VOLTAGE) == 0);
    STATES(supervisor.mode == HEXAGEN_MODE_TRIPPED);
    STATES(supervisor.fault == HEXAGEN_FAULT_OVER_VOLTAGE);
    return 0;
}

/* A sample with counts of the two sensors; that of the third phase says nothing. */
static hexagen_sample sample_of(
    const hexagen_limits *limits, uint16_t first, uint16_t second, uint16_t hall)
{
    const int *const places = phases[limits->sensed];
    hexagen_sample sample = hexagen_with_hall(first, first, hall);
    sample.adc[2] = 0;
    sample.adc[places[0]] = first;
    sample.adc[places[1]] = second;
    return sample;
}

int main(void)
{
    if (brakes() != 0 || chatters() != 0 || waits() != 0 || bridges() != 0 || judges_the_bus() != 0
        || judges_offsets() != 0) {
        return 1;
    }
    for (unsigned set = 0; set < sizeof all / sizeof all[0]; set++) {
        const hexagen_limits *const limits = all[set];
        const hexagen_sensor *const both = limits->sensors;
        const uint16_t others[] = { 0, 1, both[0].offset, (uint16_t)(limits->adc_max - 1U),
            limits->adc_max, 65535 };
        for (uint32_t count = 0; count <= 65535; count++) {
            for (unsigned choice = 0; choice < 6 * 4; choice++) {
                const uint16_t hall = (uint16_t)((count + choice) % 9U);
                const uint16_t offset_a =
                    (choice & 1U) ? both[0].offset_most : both[0].offset_least;
                const uint16_t offset_b =
                    (choice & 2U) ? both[1].offset_most : both[1].offset_least;
                const hexagen_mode mode =
                    (count % 7U == 0U) ? (hexagen_mode)(count % 4U) : HEXAGEN_MODE_RUN;
                const uint16_t other = others[choice >> 2];
                const hexagen_sample sample =
                    sample_of(limits, (uint16_t)count, other, hall);
                const hexagen_sample turned =
                    sample_of(limits, other, (uint16_t)count, hall);
                if (try(limits, sample, offset_a, offset_b, mode) != 0
                    || try(limits, turned, offset_a, offset_b, mode) != 0) {
                    return 1;
                }
            }
        }
    }
    for (unsigned fault = 0; fault < HEXAGEN_FAULT_STALL; fault++) {
        if (passed < 100000 || tripped[fault] < 10000) {
            printf("%lu passed, %lu with fault %u\n", passed, tripped[fault], fault);
            return 1;
        }
    }
    printf("no difference\n");
    return 0;
}
