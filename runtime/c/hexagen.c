/* Runtime of hexagen's drives, off the normal path: see hexagen.h. */
#include "hexagen.h"

#if HEXAGEN_ABI != 7
#error "hexagen.c and hexagen.h are of different versions of hexagen: take both from one."
#endif

/* ---- Arithmetic -------------------------------------------------------------------------- */

/**
 * Quotient, below 2^16, of above 2^16 + next and a divisor above `above` with its highest bit set;
 * `above` becomes the rest.
 */
static uint32_t divide_digit(uint32_t *above, uint32_t next, uint32_t divisor)
{
    const uint32_t top = divisor >> 16;
    const uint32_t bottom = divisor & UINT32_C(0xffff);
    /* An estimate by the divisor's upper half alone is up to two too large. */
    uint32_t digit = *above / top;
    uint32_t rest = *above - digit * top;
    if (digit * bottom > ((rest << 16) | next)) {
        digit -= 1U;
        rest += top;
        if ((rest >> 16) == 0U && digit * bottom > ((rest << 16) | next)) {
            digit -= 1U;
        }
    }
    *above = ((*above << 16) | next) - digit * divisor;
    return digit;
}

/*
 * Two digits of 16 bits (Knuth, The Art of Computer Programming, volume 2, 4.3.1, algorithm D): a
 * library takes hundreds of instructions to divide 64 bits.
 */
int32_t hexagen_divide(int32_t numerator, int32_t denominator, int32_t limit, uint16_t shift)
{
    uint64_t dividend = (uint64_t)numerator << shift;
    uint32_t divisor = (uint32_t)denominator;
    const bool is_one_digit = limit <= INT32_C(0xffff);
    uint32_t rest;
    uint32_t quotient;
    if ((dividend >> (is_one_digit ? 16 : 32)) >= divisor) {
        return limit;
    }
    if (divisor < UINT32_C(0x10000)) {
        divisor <<= 16;
        dividend <<= 16;
    }
    if (divisor < UINT32_C(0x1000000)) {
        divisor <<= 8;
        dividend <<= 8;
    }
    if (divisor < UINT32_C(0x10000000)) {
        divisor <<= 4;
        dividend <<= 4;
    }
    if (divisor < UINT32_C(0x40000000)) {
        divisor <<= 2;
        dividend <<= 2;
    }
    if (divisor < UINT32_C(0x80000000)) {
        divisor <<= 1;
        dividend <<= 1;
    }
    if (is_one_digit) {
        rest = (uint32_t)(dividend >> 16);
        quotient = 0U;
    } else {
        rest = (uint32_t)(dividend >> 32);
        quotient = divide_digit(&rest, (uint32_t)(dividend >> 16) & UINT32_C(0xffff), divisor) << 16;
    }
    quotient |= divide_digit(&rest, (uint32_t)dividend & UINT32_C(0xffff), divisor);
    return (quotient < (uint32_t)limit) ? (int32_t)quotient : limit;
}

int32_t hexagen_thousandths(int32_t number)
{
    const int32_t most = INT32_C(32767999);
    /* 2^16/1000 = 65.536: the integer part, and the fraction with 31 bits. */
    const int32_t rest = INT32_C(1151051235);
    const int32_t limited = hexagen_clamp(number, -most, most);
    return limited * 65 + hexagen_mul_round(rest, limited, 31);
}

int32_t hexagen_scaled_torque(int32_t bits, int32_t ratio)
{
    const int32_t most = INT32_C(1) << 30;
    return hexagen_mul_round(ratio, hexagen_clamp(bits, -most, most), 28);
}

int32_t hexagen_torque_constant_ratio(int32_t ratio)
{
    const int32_t inverse = ratio >> 13;
    /* 0 before the drive is initialised. */
    return inverse > 0 ? INT32_C(2) * ((INT32_C(1) << 30) / inverse) : 0;
}

/** An angle of 2^32 a turn in degrees with 16 fraction bits. */
static int32_t degrees_of(int32_t angle)
{
    return hexagen_mul_round(INT32_C(360), angle, 16);
}

void hexagen_hall_offsets(int32_t first, int32_t second, int32_t all, int32_t degrees[3])
{
    const int32_t third = -(first + second);
    /* The sensor between the others is taken to be in its place. */
    const int32_t middle =
        hexagen_max(hexagen_min(first, second), hexagen_min(hexagen_max(first, second), third));
    const int32_t common = all - middle;
    degrees[0] = degrees_of(first + common);
    degrees[1] = degrees_of(second + common);
    degrees[2] = degrees_of(third + common);
}

int32_t hexagen_whole(int32_t number)
{
    if (number > INT32_C(32767)) {
        return INT32_MAX;
    }
    return hexagen_shift_left(hexagen_max(number, -INT32_C(32768)), 16);
}

/* ---- Supervision ------------------------------------------------------------------------- */

/** The mode of a drive that is to control with so many periods of a start before. */
static hexagen_mode before_control(uint16_t periods)
{
    return (periods == 0U) ? HEXAGEN_MODE_RUN : HEXAGEN_MODE_START;
}

/** Nothing is known of the rotor. */
static void forget_turn(hexagen_supervisor *supervisor)
{
    supervisor->turn_hall = 0;
    supervisor->turn_age = 0;
    supervisor->turn_interval = 0;
    supervisor->turn_direction = 0;
}

/** Control follows, once the rotor's angle is known. */
static void start(hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    supervisor->countdown = limits->start_periods;
    supervisor->mode = before_control(limits->start_periods);
    forget_turn(supervisor);
}

static void forget_sums(hexagen_supervisor *supervisor)
{
    supervisor->sum[0] = 0;
    supervisor->sum[1] = 0;
    supervisor->sum[2] = 0;
}

/** The nominal offset of a sensor, words of current. */
static int32_t nominal_offset(const hexagen_limits *limits, uint16_t sensor)
{
    return hexagen_wrap((uint32_t)limits->sensors[sensor].offset << limits->current_bits);
}

void hexagen_start(hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    supervisor->fault = HEXAGEN_FAULT_NONE;
    supervisor->hall_prev = 0;
    supervisor->hall_gap = 0;
    supervisor->hall_glitches = 0;
    supervisor->stall_count = 0;
    forget_sums(supervisor);
    supervisor->offset[0] = nominal_offset(limits, 0);
    supervisor->offset[1] = nominal_offset(limits, 1);
    supervisor->offset[2] = limits->third.is_there ? nominal_offset(limits, 2) : 0;
    supervisor->sum_count = 0;
    supervisor->unread = 0;
    start(supervisor, limits);
}

/** Turns all legs off until a reset. The first fault is kept. */
static void trip(hexagen_supervisor *supervisor, hexagen_fault fault)
{
    if (supervisor->mode != HEXAGEN_MODE_TRIPPED) {
        supervisor->fault = fault;
    }
    supervisor->mode = HEXAGEN_MODE_TRIPPED;
}

static bool is_bad_offset(const hexagen_limits *limits, uint16_t sensor, int32_t sum)
{
    const uint16_t log2 = limits->calibration_log2;
    return sum < hexagen_shift_left((int32_t)limits->sensors[sensor].offset_least, log2)
        || sum > hexagen_shift_left((int32_t)limits->sensors[sensor].offset_most, log2);
}

/** The mean of a calibration's counts in words of current, rounded down. */
static int32_t mean(const hexagen_limits *limits, int32_t sum)
{
    const uint16_t bits = limits->current_bits;
    const uint16_t log2 = limits->calibration_log2;
    return (bits >= log2) ? hexagen_shift_left(sum, (uint16_t)(bits - log2))
                          : hexagen_shift_right(sum, (uint16_t)(log2 - bits));
}

static void end_calibration(hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    const bool has_third = limits->third.is_there;
    if (is_bad_offset(limits, 0, supervisor->sum[0]) || is_bad_offset(limits, 1, supervisor->sum[1])
        || (has_third && is_bad_offset(limits, 2, supervisor->sum[2]))) {
        trip(supervisor, HEXAGEN_FAULT_OFFSET);
        return;
    }
    supervisor->offset[0] = mean(limits, supervisor->sum[0]);
    supervisor->offset[1] = mean(limits, supervisor->sum[1]);
    supervisor->offset[2] = has_third ? mean(limits, supervisor->sum[2]) : 0;
    supervisor->countdown = limits->precharge_periods;
    supervisor->mode = HEXAGEN_MODE_PRECHARGE;
    if (limits->precharge_periods == 0U) {
        start(supervisor, limits);
    }
}

/** Counts a period down; true for the last one. */
static bool is_last(hexagen_supervisor *supervisor)
{
    if (supervisor->countdown != 0U) {
        supervisor->countdown = (uint16_t)(supervisor->countdown - 1U);
    }
    return supervisor->countdown == 0U;
}

/** Adds the count of a calibration sample. */
static void add_count(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample, uint16_t sensor)
{
    /* The countdown ends the sums before this limit, whatever the initial state. */
    const int32_t most = hexagen_shift_left((int32_t)limits->adc_max, limits->calibration_log2);
    const int32_t count = (int32_t)hexagen_count_within(limits, sample, sensor);
    supervisor->sum[sensor] = hexagen_min(supervisor->sum[sensor] + count, most);
}

/**
 * Calibration averages the counts of all its samples; then pre-charge counts its periods down, and
 * the start follows.
 */
static void start_up(
    hexagen_supervisor *supervisor, const hexagen_limits *limits, const hexagen_sample *sample)
{
    switch (supervisor->mode) {
    case HEXAGEN_MODE_CALIBRATE:
        add_count(supervisor, limits, sample, 0);
        add_count(supervisor, limits, sample, 1);
        if (limits->third.is_there) {
            add_count(supervisor, limits, sample, 2);
        }
        if (is_last(supervisor)) {
            end_calibration(supervisor, limits);
        }
        break;
    case HEXAGEN_MODE_PRECHARGE:
        if (is_last(supervisor)) {
            start(supervisor, limits);
        }
        break;
    case HEXAGEN_MODE_START:
        supervisor->mode = before_control(supervisor->countdown);
        break;
    case HEXAGEN_MODE_RUN:
    case HEXAGEN_MODE_TRIPPED:
    case HEXAGEN_MODE_COAST:
    case HEXAGEN_MODE_BRAKE:
    default:
        break;
    }
}

/** The first fault of a sample. */
static hexagen_fault find_fault(const hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample, bool has_hall, int32_t first, int32_t second)
{
    if (hexagen_has_end(supervisor, limits, sample)) {
        return HEXAGEN_FAULT_ADC_RANGE;
    }
    if (!has_hall) {
        return HEXAGEN_FAULT_HALL;
    }
    /* Without offsets a count tells no current. */
    if (supervisor->mode != HEXAGEN_MODE_CALIBRATE && hexagen_is_over(limits, first, second)) {
        return HEXAGEN_FAULT_OVER_CURRENT;
    }
    if (hexagen_is_sum_off(supervisor, limits)) {
        return HEXAGEN_FAULT_CURRENT_SUM;
    }
    return hexagen_is_stalled(supervisor, limits) ? HEXAGEN_FAULT_STALL : HEXAGEN_FAULT_NONE;
}

/**
 * Takes a sample with a disturbed Hall code as one more of a gap; false if the gap is too long, or no
 * code is known yet.
 */
static bool bridge(hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    if (supervisor->hall_prev == 0U || supervisor->hall_gap >= limits->hall_glitches) {
        return false;
    }
    supervisor->hall_gap = (uint16_t)(supervisor->hall_gap + 1U);
    if (supervisor->hall_glitches < HEXAGEN_MOST_GLITCHES) {
        supervisor->hall_glitches = (uint16_t)(supervisor->hall_glitches + 1U);
    }
    return true;
}

/** Sector of a Hall code; 0 of an invalid one. */
static uint32_t sector_of(const hexagen_limits *limits, uint16_t hall)
{
    return hexagen_is_hall_code(hall) ? (limits->sectors >> (4U * hall)) & 7U : 0U;
}

/** Whether a sector is the next one of the other, forward. */
static bool follows(uint32_t sector, uint32_t next)
{
    return next == ((sector == 6U) ? 1U : sector + 1U);
}

/**
 * Whether a sector lasts long enough for a short-circuited motor to take at most the largest current.
 * A slow rotor stays so until two edges in one direction show another speed: one disturbed sample
 * gives two edges, too, but there and back.
 */
static bool is_slow(const hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    return hexagen_max(supervisor->turn_age, supervisor->turn_interval) == limits->brake_periods;
}

/** Follows an edge of the rotor; whether it is the second in a row in one direction. */
static bool follow_edge(
    hexagen_supervisor *supervisor, const hexagen_limits *limits, int32_t direction)
{
    const bool is_second = direction != 0 && direction == supervisor->turn_direction;
    if (is_second) {
        supervisor->turn_interval = supervisor->turn_age;
        supervisor->turn_age = 0;
    } else if (!is_slow(supervisor, limits)) {
        supervisor->turn_interval = 0;
        if (supervisor->turn_direction == 0 && direction != 0) {
            supervisor->turn_age = 0;
        }
    }
    supervisor->turn_direction = direction;
    return is_second;
}

/**
 * Follows the rotor for a control period; whether it ends in an edge that is the second in a row in
 * one direction.
 */
static bool is_known(hexagen_supervisor *supervisor, const hexagen_limits *limits, uint16_t hall)
{
    const uint32_t before = sector_of(limits, supervisor->turn_hall);
    const uint32_t now = sector_of(limits, hall);
    bool is_second = false;
    if (before != 0U && now != before) {
        const int32_t direction = follows(before, now) ? 1 : follows(now, before) ? -1 : 0;
        is_second = follow_edge(supervisor, limits, direction);
    }
    supervisor->turn_hall = hall;
    supervisor->turn_age = hexagen_min(supervisor->turn_age + 1, limits->brake_periods);
    return is_second;
}

/** Follows a rotor without control, and counts a start down, which the rotor's angle ends. */
static void follow(hexagen_supervisor *supervisor, const hexagen_limits *limits, uint16_t hall)
{
    if (is_known(supervisor, limits, hall)) {
        supervisor->countdown = 0;
    } else {
        (void)is_last(supervisor);
    }
}

/**
 * Whether braking asks for torque against a rotor, a fast one; a slow one is shorted through the lower
 * switches, and an interrupted start goes on first.
 */
static bool is_against(const hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    return supervisor->countdown == 0U && !is_slow(supervisor, limits);
}

static int32_t current_within(const hexagen_limits *limits, int32_t current)
{
    return hexagen_clamp(current, limits->current_least, limits->current_most);
}

hexagen_unfit hexagen_examine(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample, hexagen_fault known, hexagen_checked *checked)
{
    int32_t first;
    int32_t second;
    const uint16_t sampled = hexagen_hall_of(limits, sample);
    const bool is_sound = hexagen_is_sound(supervisor, limits, sampled);
    const bool is_bridged = !is_sound && bridge(supervisor, limits);
    const uint16_t hall = is_bridged      ? supervisor->hall_prev
        : hexagen_is_hall_code(sampled) ? sampled
                                        : 0U;
    hexagen_unfit unfit = { false, false, 0, known };
    hexagen_sense(supervisor, limits, hexagen_count_within(limits, sample, 0),
        hexagen_count_within(limits, sample, 1), hexagen_count_within(limits, sample, 2), &first,
        &second);
    hexagen_take_currents(limits, checked, first, second, hexagen_third(first, second));
    checked->i_a = current_within(limits, checked->i_a);
    checked->i_b = current_within(limits, checked->i_b);
    checked->hall = (int32_t)hall;
    checked->hall_ticks = (int32_t)sample->hall_ticks;
    checked->angle = hexagen_wrap(sample->angle);
    if (known == HEXAGEN_FAULT_NONE) {
        unfit.fault
            = find_fault(supervisor, limits, sample, is_sound || is_bridged, first, second);
    }
    if (unfit.fault != HEXAGEN_FAULT_NONE) {
        return unfit;
    }
    if (supervisor->mode == HEXAGEN_MODE_START || supervisor->mode == HEXAGEN_MODE_COAST
        || supervisor->mode == HEXAGEN_MODE_BRAKE) {
        follow(supervisor, limits, hall);
    }
    if (supervisor->mode == HEXAGEN_MODE_RUN) {
        unfit.is_controlled = is_bridged;
    } else if (supervisor->mode == HEXAGEN_MODE_BRAKE && is_against(supervisor, limits)) {
        unfit.is_controlled = true;
        unfit.is_braking = true;
        unfit.against = (supervisor->turn_interval == 0) ? 0 : supervisor->turn_direction;
    }
    return unfit;
}

hexagen_leg hexagen_rest(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample, hexagen_fault fault)
{
    hexagen_leg leg = HEXAGEN_LEG_OFF;
    hexagen_legs legs;
    if (fault != HEXAGEN_FAULT_NONE) {
        trip(supervisor, fault);
    } else {
        if (supervisor->mode == HEXAGEN_MODE_PRECHARGE
            || (supervisor->mode == HEXAGEN_MODE_BRAKE && supervisor->countdown == 0U)) {
            leg = HEXAGEN_LEG_LOW;
        }
        start_up(supervisor, limits, sample);
    }
    legs = hexagen_all_legs(leg);
    hexagen_follow_legs(supervisor, limits, &legs);
    return leg;
}

void hexagen_keep(volatile hexagen_supervisor *kept, const hexagen_supervisor *supervisor)
{
    kept->mode = supervisor->mode;
    kept->fault = supervisor->fault;
    kept->countdown = supervisor->countdown;
    kept->hall_prev = supervisor->hall_prev;
    kept->hall_gap = supervisor->hall_gap;
    kept->hall_glitches = supervisor->hall_glitches;
    kept->stall_count = supervisor->stall_count;
    kept->sum[0] = supervisor->sum[0];
    kept->sum[1] = supervisor->sum[1];
    kept->sum[2] = supervisor->sum[2];
    kept->offset[0] = supervisor->offset[0];
    kept->offset[1] = supervisor->offset[1];
    kept->offset[2] = supervisor->offset[2];
    kept->sum_count = supervisor->sum_count;
    kept->unread = supervisor->unread;
    kept->turn_hall = supervisor->turn_hall;
    kept->turn_age = supervisor->turn_age;
    kept->turn_interval = supervisor->turn_interval;
    kept->turn_direction = supervisor->turn_direction;
}

/**
 * Whether control is on, to begin next, or off on purpose: neither calibrating nor pre-charging, and
 * not tripped.
 */
static bool is_ready(const hexagen_supervisor *supervisor)
{
    return supervisor->mode == HEXAGEN_MODE_RUN || supervisor->mode == HEXAGEN_MODE_START
        || supervisor->mode == HEXAGEN_MODE_COAST || supervisor->mode == HEXAGEN_MODE_BRAKE;
}

static void stop(hexagen_supervisor *supervisor, hexagen_mode mode)
{
    if (!is_ready(supervisor)) {
        return;
    }
    /* In control the rotor is not followed here. */
    if (supervisor->mode == HEXAGEN_MODE_RUN) {
        forget_turn(supervisor);
    }
    supervisor->mode = mode;
}

void hexagen_coast(hexagen_supervisor *supervisor)
{
    stop(supervisor, HEXAGEN_MODE_COAST);
}

void hexagen_brake(hexagen_supervisor *supervisor)
{
    stop(supervisor, HEXAGEN_MODE_BRAKE);
}

bool hexagen_resume(hexagen_supervisor *supervisor)
{
    const bool is_off =
        supervisor->mode == HEXAGEN_MODE_COAST || supervisor->mode == HEXAGEN_MODE_BRAKE;
    if (is_off) {
        supervisor->mode = before_control(supervisor->countdown);
    }
    return is_off;
}

bool hexagen_reset(hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    const hexagen_supervisor before = *supervisor;
    if (!is_ready(supervisor) && supervisor->mode != HEXAGEN_MODE_TRIPPED) {
        return false;
    }
    hexagen_start(supervisor, limits);
    supervisor->offset[0] = before.offset[0];
    supervisor->offset[1] = before.offset[1];
    supervisor->offset[2] = before.offset[2];
    supervisor->unread = before.unread;
    return true;
}

void hexagen_calibrate(hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    if (supervisor->mode != HEXAGEN_MODE_TRIPPED) {
        supervisor->mode = HEXAGEN_MODE_CALIBRATE;
        supervisor->countdown = (uint16_t)(1U << limits->calibration_log2);
        forget_sums(supervisor);
    }
}

void hexagen_precharge(hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    const bool may_begin =
        supervisor->mode == HEXAGEN_MODE_RUN || supervisor->mode == HEXAGEN_MODE_START
        || supervisor->mode == HEXAGEN_MODE_PRECHARGE;
    if (may_begin && limits->precharge_periods != 0U) {
        supervisor->mode = HEXAGEN_MODE_PRECHARGE;
        supervisor->countdown = limits->precharge_periods;
    }
}

/* ---- Bus voltage ------------------------------------------------------------------------- */

void hexagen_start_bus(hexagen_bus *bus, int32_t first, int32_t second)
{
    bus->banks[0][0] = first;
    bus->banks[0][1] = second;
    bus->banks[1][0] = first;
    bus->banks[1][1] = second;
    bus->published = 0;
    bus->storing = 0;
    bus->told = 0;
    bus->left = 0;
}

void hexagen_tell_bus(hexagen_bus *bus, int32_t first, int32_t second, int32_t judged)
{
    int32_t spare;
    /* The interrupted call would go on filling the bank that this one publishes. */
    if (bus->storing != 0) {
        return;
    }
    bus->storing = HEXAGEN_GIVEN_UP;
    spare = (bus->published == 0) ? 1 : 0;
    bus->banks[spare][0] = first;
    bus->banks[spare][1] = second;
    bus->published = spare;
    bus->storing = 0;
    bus->told = judged;
}

/* ---- Signals ------------------------------------------------------------------------------ */

#ifdef HEXAGEN_SIGNALS
void hexagen_start_port(hexagen_port *port)
{
    port->turn = 0;
}

/** Timer counts of an interval, if a leg's upper switch is on in it, else 0. */
static uint16_t on_in(
    hexagen_intervals intervals, uint16_t interval, uint16_t leg, uint16_t length)
{
    const bool is_on = hexagen_leg_in(intervals, interval, leg) == HEXAGEN_LEG_PULSED;
    return is_on ? length : (uint16_t)0;
}

static void show_leg(hexagen_legs *legs, hexagen_intervals intervals, uint16_t leg)
{
    const uint16_t first = intervals.end[0];
    const uint16_t second =
        (intervals.end[1] > first) ? (uint16_t)(intervals.end[1] - first) : (uint16_t)0;
    const bool is_off = hexagen_leg_in(intervals, 0, leg) == HEXAGEN_LEG_OFF
        && hexagen_leg_in(intervals, 1, leg) == HEXAGEN_LEG_OFF
        && hexagen_leg_in(intervals, 2, leg) == HEXAGEN_LEG_OFF;
    legs->state[leg] = is_off ? HEXAGEN_LEG_OFF : HEXAGEN_LEG_PULSED;
    legs->compare[leg] = (uint16_t)(on_in(intervals, 0, leg, first)
        + on_in(intervals, 1, leg, second));
}

hexagen_legs hexagen_legs_of(hexagen_intervals intervals)
{
    hexagen_legs legs;
    show_leg(&legs, intervals, 0);
    show_leg(&legs, intervals, 1);
    show_leg(&legs, intervals, 2);
    return legs;
}

/** Timer counts for which the upper switch of a leg is on; HEXAGEN_NONE if the leg is off. */
static int32_t on(const hexagen_legs *legs, uint16_t leg)
{
    if (legs->state[leg] == HEXAGEN_LEG_OFF) {
        return HEXAGEN_NONE;
    }
    return (legs->state[leg] == HEXAGEN_LEG_PULSED) ? (int32_t)legs->compare[leg] : 0;
}

void hexagen_answer(hexagen_port *port, hexagen_checked checked, hexagen_legs legs,
    hexagen_observation observation)
{
    port->words[0] = checked.i_a;
    port->words[1] = checked.i_b;
    port->words[2] = checked.hall;
    port->words[3] = on(&legs, 0);
    port->words[4] = on(&legs, 1);
    port->words[5] = on(&legs, 2);
    port->words[6] = observation.e_a;
    port->words[7] = observation.e_b;
    port->words[8] = observation.speed;
    port->turn = 2;
}

/** A word in its unit, as a number with 16 fraction bits; saturates. */
static int32_t in_unit(hexagen_unit unit, int32_t word)
{
    const int64_t product = (int64_t)unit.factor * word;
    const int64_t bits =
        (product >= 0) ? (product >> unit.shift) : ~(~product >> unit.shift);
    return (bits < INT32_MIN) ? INT32_MIN : (bits > INT32_MAX) ? INT32_MAX : (int32_t)bits;
}

/** Three phase values of zero sum, from those of phases a and b. */
static void of_phases(int32_t *values, hexagen_unit unit, int32_t a, int32_t b)
{
    values[0] = in_unit(unit, a);
    values[1] = in_unit(unit, b);
    values[2] = in_unit(unit, hexagen_wrap(UINT32_C(0) - ((uint32_t)a + (uint32_t)b)));
}

static void of_leg(hexagen_signals *signals, const hexagen_units *units, uint16_t leg, int32_t word)
{
    signals->is_off[leg] = word == HEXAGEN_NONE;
    signals->voltages[leg] = signals->is_off[leg] ? 0 : in_unit(units->volt_per_count, word);
}

bool hexagen_take(hexagen_port *port, const hexagen_units *units, hexagen_signals *signals)
{
    int32_t e_a;
    int32_t e_b;
    int32_t speed;
    const int32_t turn = port->turn;
    if (turn != 2) {
        /* Read once: the answer may arrive in between. */
        if (turn == 0) {
            port->turn = 1;
        }
        return false;
    }
    /* A context that interrupts here finds nothing to take. */
    port->turn = 3;
    of_phases(signals->currents, units->ampere, port->words[0], port->words[1]);
    signals->sector = units->sectors[(uint32_t)port->words[2] & 7U];
    of_leg(signals, units, 0, port->words[3]);
    of_leg(signals, units, 1, port->words[4]);
    of_leg(signals, units, 2, port->words[5]);
    e_a = port->words[6];
    e_b = port->words[7];
    speed = port->words[8];
    signals->has_emf = e_a != HEXAGEN_NONE;
    of_phases(signals->emf, units->volt, signals->has_emf ? e_a : 0, signals->has_emf ? e_b : 0);
    signals->has_speed = speed != HEXAGEN_NONE;
    signals->speed = in_unit(units->rpm, signals->has_speed ? speed : 0);
    port->turn = 0;
    return true;
}
#endif

/* ---- Verification ------------------------------------------------------------------------ */

#ifdef HEXAGEN_VERIFICATION
void hexagen_words(const hexagen_supervisor *supervisor, int32_t *words)
{
    words[0] = (int32_t)supervisor->mode;
    words[1] = (int32_t)supervisor->fault;
    words[2] = (int32_t)supervisor->countdown;
    words[3] = supervisor->sum[0];
    words[4] = supervisor->sum[1];
    words[5] = supervisor->offset[0];
    words[6] = supervisor->offset[1];
    words[7] = supervisor->stall_count;
    words[8] = (int32_t)supervisor->hall_prev;
    words[9] = (int32_t)supervisor->hall_gap;
    words[10] = (int32_t)supervisor->hall_glitches;
    words[11] = (int32_t)supervisor->turn_hall;
    words[12] = supervisor->turn_age;
    words[13] = supervisor->turn_interval;
    words[14] = supervisor->turn_direction;
    words[15] = supervisor->sum[2];
    words[16] = supervisor->offset[2];
    words[17] = (int32_t)supervisor->sum_count;
    words[18] = (int32_t)supervisor->unread;
}

void hexagen_set_words(hexagen_supervisor *supervisor, const int32_t *words)
{
    supervisor->mode = (hexagen_mode)words[0];
    supervisor->fault = (hexagen_fault)words[1];
    supervisor->countdown = (uint16_t)words[2];
    supervisor->sum[0] = words[3];
    supervisor->sum[1] = words[4];
    supervisor->offset[0] = words[5];
    supervisor->offset[1] = words[6];
    supervisor->stall_count = words[7];
    supervisor->hall_prev = (uint16_t)words[8];
    supervisor->hall_gap = (uint16_t)words[9];
    supervisor->hall_glitches = (uint16_t)words[10];
    supervisor->turn_hall = (uint16_t)words[11];
    supervisor->turn_age = words[12];
    supervisor->turn_interval = words[13];
    supervisor->turn_direction = words[14];
    supervisor->sum[2] = words[15];
    supervisor->offset[2] = words[16];
    supervisor->sum_count = (uint16_t)words[17];
    supervisor->unread = (uint16_t)words[18];
}
#endif
