/**
 * What the drives of hexagen have in common, in C99: samples and commands, supervision, arithmetic.
 *
 * A drive is emitted per motor and controller as `hub_drive.h` and `hub_drive.c`: constants, tables
 * and the control law. This header and `hexagen.c` are the rest, the same for all drives of a
 * program. A compiler needs `stdbool.h`, `stdint.h`, and types of 16, 32 and 64 bits; none of 8,
 * which some cores do not have. No signed number overflows, and no negative one is shifted.
 *
 * One context, the control interrupt, calls a drive's `step`; `init`, `reset`, `calibrate` and
 * `precharge` belong to it or run while it does not. From all other contexts of the same core:
 * setters, `status` and `signals`. A word that passes between contexts is a `volatile int32_t`,
 * which cores of 32 bits and a C2000 load and store in one instruction; where that takes several,
 * keep the interrupt out around these calls.
 */
#ifndef HEXAGEN_H
#define HEXAGEN_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What drives rely on here. They refuse to compile with a header of another number. */
#define HEXAGEN_ABI 1

/** A function off the normal path, which is not to be inlined into it. */
#if defined(__GNUC__) || defined(__clang__)
#define HEXAGEN_COLD __attribute__((cold, noinline))
#else
#define HEXAGEN_COLD
#endif

/* ---- Samples and commands ---------------------------------------------------------------- */

/** The measurements at the begin of a control period, as the hardware gives them. */
typedef struct {
    /** ADC counts of the currents of phases a, b, c; 0 where there is no sensor. */
    uint16_t adc[3];
    /** Hall code `Ha Hb Hc`, Ha in bit 2; 0 where there is an angle. */
    uint16_t hall;
    /** Timer ticks from the last Hall edge to this sample, stopping at 65535. */
    uint16_t hall_ticks;
    /** Electrical angle, 2^32 a turn; 0 where there is a Hall code. */
    uint32_t angle;
} hexagen_sample;

/**
 * ADC counts of phases a and b, and a Hall code. Any code may be given: one that Hall sensors
 * cannot have (0, 7 and above) trips the drive.
 */
static inline hexagen_sample hexagen_with_hall(uint16_t adc_a, uint16_t adc_b, uint16_t hall)
{
    hexagen_sample sample;
    sample.adc[0] = adc_a;
    sample.adc[1] = adc_b;
    sample.adc[2] = 0;
    sample.hall = hall;
    sample.hall_ticks = 0;
    sample.angle = 0;
    return sample;
}

/**
 * ADC counts of phases a and b, and an electrical angle, 2^32 a turn, 0 where the EMF of phase a
 * rises through 0. It has no Hall code: a drive that needs one trips.
 */
static inline hexagen_sample hexagen_with_angle(uint16_t adc_a, uint16_t adc_b, uint32_t angle)
{
    hexagen_sample sample = hexagen_with_hall(adc_a, adc_b, 0);
    sample.angle = angle;
    return sample;
}

/**
 * The same sample with the time since the last Hall edge, for drives with `hall_capture: timer`.
 *
 * Code and ticks are one snapshot, which no edge may tear apart: latch both in the capture
 * interrupt, or read the ticks, the code, and the ticks again, until the second count is not below
 * the first.
 */
static inline hexagen_sample hexagen_with_ticks(hexagen_sample sample, uint16_t hall_ticks)
{
    sample.hall_ticks = hall_ticks;
    return sample;
}

/** The same sample with the ADC count of phase c, for drives with three sensors. */
static inline hexagen_sample hexagen_with_third(hexagen_sample sample, uint16_t adc_c)
{
    sample.adc[2] = adc_c;
    return sample;
}

/** What a leg of the inverter does for one PWM period. */
typedef enum {
    /** Both switches follow the timer channel (complementary outputs). */
    HEXAGEN_LEG_PULSED = 0,
    /** The lower switch is on for the whole period, the upper one off. */
    HEXAGEN_LEG_LOW = 1,
    /** Both switches are off: the leg floats or its diodes conduct. */
    HEXAGEN_LEG_OFF = 2
} hexagen_leg;

/** The state of a number: 0 pulsed, 1 low, else off. */
static inline hexagen_leg hexagen_leg_of(int32_t number)
{
    return (number == 0) ? HEXAGEN_LEG_PULSED : (number == 1) ? HEXAGEN_LEG_LOW : HEXAGEN_LEG_OFF;
}

/**
 * Compare values for a centre-aligned timer and a state per leg, of legs a, b, c.
 *
 * A compare value is the time for which the upper switch is on, timer counts from 0 to the timer's
 * period. It is 0 for a leg that is not pulsed.
 */
typedef struct {
    uint16_t compare[3];
    hexagen_leg state[3];
} hexagen_legs;

/** All legs alike, without pulses. */
static inline hexagen_legs hexagen_all_legs(hexagen_leg state)
{
    const hexagen_legs legs = { { 0, 0, 0 }, { state, state, state } };
    return legs;
}

/* ---- Status ------------------------------------------------------------------------------ */

/** What a drive is doing. */
typedef enum {
    /** Current control. */
    HEXAGEN_MODE_RUN = 0,
    /** Averaging the current offsets, all legs off. */
    HEXAGEN_MODE_CALIBRATE = 1,
    /** Charging the bootstrap capacitors, all lower switches on. */
    HEXAGEN_MODE_PRECHARGE = 2,
    /** Tripped, all legs off, until `reset`. */
    HEXAGEN_MODE_TRIPPED = 3
} hexagen_mode;

/** Why a drive tripped. Where one sample has several causes, the first of this list is told. */
typedef enum {
    /** Not tripped. */
    HEXAGEN_FAULT_NONE = 0,
    /** A current ADC was at an end of its range: count 0, the largest count, or more. */
    HEXAGEN_FAULT_ADC_RANGE = 1,
    /** The Hall code was none that three sensors can have: 000, 111 or above. */
    HEXAGEN_FAULT_HALL = 3,
    /** A phase current was above the trip level. */
    HEXAGEN_FAULT_OVER_CURRENT = 2,
    /** No Hall edge within the stall time-out while a set-point was not 0. */
    HEXAGEN_FAULT_STALL = 4,
    /** A calibrated current offset was too far from its nominal value. */
    HEXAGEN_FAULT_OFFSET = 5
} hexagen_fault;

/** What a drive is doing and what tripped it, as of the end of the last control period or call. */
typedef struct {
    hexagen_mode mode;
    hexagen_fault fault;
    /**
     * `v_bus: measured`: for 100 ms no call of `set_bus` took effect, so the controller goes by an
     * old voltage; from the start to the first call by the nominal one. A warning, which trips
     * nothing. Never with `v_bus: fixed`.
     */
    bool bus_is_stale;
} hexagen_status;

/** What the control loop published as one word, mode in the lower 8 bits and fault above. */
static inline hexagen_status hexagen_status_of(int32_t word, bool bus_is_stale)
{
    hexagen_status status;
    status.mode = (hexagen_mode)(word & 0xff);
    status.fault = (hexagen_fault)(word >> 8);
    status.bus_is_stale = bus_is_stale;
    return status;
}

/* ---- Arithmetic -------------------------------------------------------------------------- */

/** The two's complement word of these bits. */
static inline int32_t hexagen_wrap(uint32_t bits)
{
    return (bits <= UINT32_C(0x7fffffff)) ? (int32_t)bits : -1 - (int32_t)~bits;
}

/** x 2^shift; shift is 0 to 30. */
static inline int32_t hexagen_shift_left(int32_t x, uint16_t shift)
{
    return x * (INT32_C(1) << shift);
}

/** floor(x / 2^shift): an arithmetic shift, written without a right shift of negative numbers. */
static inline int32_t hexagen_shift_right(int32_t x, uint16_t shift)
{
    return (x >= 0) ? (x >> shift) : ~(~x >> shift);
}

/** floor(x / 2^shift), as a word: the quotient is known to fit. */
static inline int32_t hexagen_shift_right_wide(int64_t x, uint16_t shift)
{
    return (int32_t)((x >= 0) ? (x >> shift) : ~(~x >> shift));
}

/** Sum of two angles: a turn is 2^32, so that sums wrap. */
static inline int32_t hexagen_angle_add(int32_t a, int32_t b)
{
    return hexagen_wrap((uint32_t)a + (uint32_t)b);
}

/** Difference of two angles: a turn is 2^32, so that differences wrap. */
static inline int32_t hexagen_angle_sub(int32_t a, int32_t b)
{
    return hexagen_wrap((uint32_t)a - (uint32_t)b);
}

/** |x| */
static inline int32_t hexagen_abs(int32_t x)
{
    return (x < 0) ? -x : x;
}

/** The lesser of the two. */
static inline int32_t hexagen_min(int32_t a, int32_t b)
{
    return (a < b) ? a : b;
}

/** The greater of the two. */
static inline int32_t hexagen_max(int32_t a, int32_t b)
{
    return (a > b) ? a : b;
}

/** `low` below `low`, `high` above `high`. */
static inline int32_t hexagen_clamp(int32_t x, int32_t low, int32_t high)
{
    return hexagen_min(hexagen_max(x, low), high);
}

/** Whether |x| > limit, which is not negative. */
static inline bool hexagen_exceeds(int32_t x, int32_t limit)
{
    return (uint32_t)x + (uint32_t)limit > UINT32_C(2) * (uint32_t)limit;
}

/** floor((coefficient signal + 2^(shift-1)) / 2^shift): rounded half up. */
static inline int32_t hexagen_mul_round(int32_t coefficient, int32_t signal, uint16_t shift)
{
    const int64_t half = INT64_C(1) << (shift - 1);
    return hexagen_shift_right_wide((int64_t)coefficient * signal + half, shift);
}

/** As hexagen_mul_round, for products that fit a word together with their rounding. */
static inline int32_t hexagen_mul_round_narrow(int32_t coefficient, int32_t signal, uint16_t shift)
{
    return hexagen_shift_right(coefficient * signal + (INT32_C(1) << (shift - 1)), shift);
}

/** floor(a b / 2^shift) */
static inline int32_t hexagen_mul_floor(int32_t a, int32_t b, uint16_t shift)
{
    return hexagen_shift_right_wide((int64_t)a * b, shift);
}

/** floor((a b + c d) / 2^shift) of a sum that fits 64 bits. */
static inline int32_t hexagen_mul_add_floor(
    int32_t a, int32_t b, int32_t c, int32_t d, uint16_t shift)
{
    return hexagen_shift_right_wide((int64_t)a * b + (int64_t)c * d, shift);
}

/** min(a b, limit) for factors that are not negative; the product may exceed the word. */
static inline int32_t hexagen_mul_limited(int32_t a, int32_t b, int32_t limit)
{
    const int64_t product = (int64_t)a * b;
    return (product < limit) ? (int32_t)product : limit;
}

/**
 * min(floor(numerator 2^shift / denominator), limit) for a numerator and a limit that are not
 * negative, and a denominator of at least 1. For paths off the normal one.
 */
int32_t hexagen_divide(int32_t numerator, int32_t denominator, int32_t limit, uint16_t shift);

/** As hexagen_divide, where the shifted numerator fits 32 bits. */
static inline int32_t hexagen_divide_narrow(
    int32_t numerator, int32_t denominator, int32_t limit, uint16_t shift)
{
    const uint32_t quotient = ((uint32_t)numerator << shift) / (uint32_t)denominator;
    return (quotient < (uint32_t)limit) ? (int32_t)quotient : limit;
}

/** floor((2^32 - 1) / ticks): the angle per tick, where a turn, 2^32, lasts `ticks`, at least 2. */
static inline int32_t hexagen_turn_over(int32_t ticks)
{
    return (int32_t)(UINT32_C(0xffffffff) / (uint32_t)ticks);
}

/** Which of `segments` equal parts of a turn the angle lies in, from 0. */
static inline int32_t hexagen_angle_index(int32_t angle, uint32_t segments)
{
    return (int32_t)(((uint64_t)(uint32_t)angle * segments) >> 32);
}

/** The position within that part, 2^31 being its whole width. */
static inline int32_t hexagen_angle_fraction(int32_t angle, uint32_t segments)
{
    return (int32_t)((uint32_t)((uint32_t)angle * segments) >> 1);
}

/** A number of thousandths as a number with 16 fraction bits, to the nearest; saturates. */
int32_t hexagen_thousandths(int32_t number);

/** A whole number as a number with 16 fraction bits; saturates. */
int32_t hexagen_whole(int32_t number);

/* ---- Supervision ------------------------------------------------------------------------- */

/**
 * What a drive's samples are judged by, and how it starts up. Words of current are ADC counts with
 * `current_bits` fraction bits.
 */
typedef struct {
    /** Largest count of the current ADC. */
    uint16_t adc_max;
    /** Whether counts fall with the current into the motor. */
    bool adc_inverted;
    /** Fraction bits of currents. */
    uint16_t current_bits;
    /** ADC count at zero current before calibration. */
    uint16_t offset;
    /** Least and greatest offset that calibration accepts, counts. */
    uint16_t offset_least;
    uint16_t offset_most;
    /** Largest phase current, words of current: one above it trips. */
    int32_t trip;
    /** Least and greatest current of any count at any accepted offset, words of current. */
    int32_t current_least;
    int32_t current_most;
    /** Base-2 logarithm of the samples of a calibration. */
    uint16_t calibration_log2;
    /** Control periods of bootstrap pre-charge; 0 where there is none. */
    uint16_t precharge_periods;
    /** Control periods without a Hall edge under demand that are a stall; 0 where none count. */
    int32_t stall_periods;
} hexagen_limits;

/**
 * Defines constant limits of this name, and refuses to compile where they contradict each other or
 * a sum or a current of theirs does not fit 32 bits.
 */
#define HEXAGEN_LIMITS(name, adc_max, adc_inverted, current_bits, offset, offset_least, \
    offset_most, trip, current_least, current_most, calibration_log2, precharge_periods, \
    stall_periods) \
    typedef int name##_hold[HEXAGEN_LIMITS_HOLD((int64_t)(adc_max), adc_inverted, current_bits, \
        (int64_t)(offset), (int64_t)(offset_least), (int64_t)(offset_most), trip, \
        (int64_t)(current_least), (int64_t)(current_most), calibration_log2, stall_periods) \
        ? 1 : -1]; \
    static const hexagen_limits name = { adc_max, adc_inverted, current_bits, offset, \
        offset_least, offset_most, trip, current_least, current_most, calibration_log2, \
        precharge_periods, stall_periods }

/** Whether limits hold; phase c is the negative sum of two currents. */
#define HEXAGEN_LIMITS_HOLD(adc_max, inverted, bits, offset, least, most, trip, low, high, log2, \
    stall) \
    ((bits) < 31 && (log2) < 16 && (adc_max) > 1 && (least) <= (offset) && (offset) <= (most) \
        && (most) <= (adc_max) && (trip) > 0 && (stall) >= 0 && (stall) < INT32_C(0x7fffffff) \
        && (low) == HEXAGEN_LEAST(adc_max, inverted, bits, most, least) \
        && (high) == HEXAGEN_MOST(adc_max, inverted, bits, most, least) \
        && -2 * (low) <= INT64_C(0x7fffffff) && 2 * (high) <= INT64_C(0x7fffffff) \
        && (adc_max) * (INT64_C(1) << ((log2) & 15)) <= INT64_C(0x7fffffff))

#define HEXAGEN_LEAST(adc_max, inverted, bits, most, least) \
    (((inverted) ? (least) - (adc_max) : -(most)) * (INT64_C(1) << ((bits) & 31)))

#define HEXAGEN_MOST(adc_max, inverted, bits, most, least) \
    (((inverted) ? (most) : (adc_max) - (least)) * (INT64_C(1) << ((bits) & 31)))

/**
 * The supervisor of a drive: its mode, its first fault, the offsets of its current ADCs.
 *
 * It trips on what samples show: a current above the trip level, a current ADC at an end of its
 * range, an invalid Hall code, and where told to, a rotor that stands. It cannot see, and nothing
 * else here does:
 *
 * - a current ADC or amplifier that is stuck or wrong within its range: one that is frozen at
 *   mid-scale can let the true current rise to several times the trip level;
 * - the current of phase c, which has no sensor: it is taken as -(a + b);
 * - a control interrupt that does not come: the last command stands;
 * - heat, shoot-through, and what is shorter than a control period;
 * - a bus voltage, be it too high for the switches.
 *
 * So the board must have (a) a comparator of the current on the timer's break input, (b) a watchdog
 * on the control interrupt and (c) a thermal limit; where the motor can brake, a limit of the bus
 * voltage, too.
 */
typedef struct {
    hexagen_mode mode;
    hexagen_fault fault;
    /** Periods left in calibration or pre-charge. */
    uint16_t countdown;
    /** Hall code of the last sample that had one, where a stall is watched for; 0 before. */
    uint16_t hall_prev;
    /** Periods without a Hall edge under demand. */
    int32_t stall_count;
    /** Sums of calibration samples, counts. */
    int32_t sum_a;
    int32_t sum_b;
    /** Offsets of phases a and b, words of current. */
    int32_t offset_a;
    int32_t offset_b;
} hexagen_supervisor;

/**
 * A sample that the supervisor has looked at: what a law goes by. Only hexagen_check and
 * hexagen_rest make one; its currents lie within `current_least` and `current_most` of the limits.
 */
typedef struct {
    /** Currents of phases a and b into the motor, words of current. */
    int32_t i_a;
    int32_t i_b;
    /** Hall code, 1 to 6; at rest 0 where the sensors gave none. */
    int32_t hall;
    /** Ticks since the last Hall edge, 0 to 65535. */
    int32_t hall_ticks;
} hexagen_checked;

/** A phase current in words of current: `count` less `offset`, a word of current. */
static inline int32_t hexagen_current(const hexagen_limits *limits, uint16_t count, int32_t offset)
{
    const uint32_t word = (uint32_t)count << limits->current_bits;
    const uint32_t zero = (uint32_t)offset;
    return hexagen_wrap(limits->adc_inverted ? zero - word : word - zero);
}

/** Whether an ADC is at an end of its range: count 0, the largest, or more. */
static inline bool hexagen_is_at_end(const hexagen_limits *limits, uint16_t count)
{
    return count == 0U || count >= limits->adc_max;
}

/** Whether three Hall sensors can give the code: 001 to 110. */
static inline bool hexagen_is_hall_code(uint16_t hall)
{
    return hall >= 1U && hall <= 6U;
}

/** Whether a phase current is above the trip level. */
static inline bool hexagen_is_over(const hexagen_limits *limits, int32_t i_a, int32_t i_b)
{
    const int32_t i_c = hexagen_wrap(UINT32_C(0) - ((uint32_t)i_a + (uint32_t)i_b));
    return hexagen_exceeds(i_a, limits->trip) || hexagen_exceeds(i_b, limits->trip)
        || hexagen_exceeds(i_c, limits->trip);
}

/** Whether the rotor has stood for too long. */
static inline bool hexagen_is_stalled(
    const hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    return limits->stall_periods != 0 && supervisor->stall_count == limits->stall_periods;
}

/** Counts periods without a Hall edge under demand; true where they are a stall. */
static inline bool hexagen_watch_stall(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    uint16_t sampled, const volatile int32_t *set_point)
{
    if (limits->stall_periods != 0) {
        const uint16_t before = supervisor->hall_prev;
        const uint16_t hall = hexagen_is_hall_code(sampled) ? sampled : before;
        const bool is_edge = hall != before && before != 0U;
        supervisor->hall_prev = hall;
        if (is_edge || *set_point == 0 || supervisor->mode != HEXAGEN_MODE_RUN) {
            supervisor->stall_count = 0;
        } else if (supervisor->stall_count < limits->stall_periods) {
            supervisor->stall_count += 1;
        } else {
            supervisor->stall_count = limits->stall_periods;
        }
    }
    return hexagen_is_stalled(supervisor, limits);
}

/**
 * Whether the period is controlled, by the checked sample. False where the drive rests in this
 * period: it is starting up or tripped, or the sample has a fault; then hexagen_rest is to be
 * called with the same sample. `set_point` is 0 where nothing is demanded of the motor.
 */
static inline bool hexagen_check(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample, const volatile int32_t *set_point, hexagen_checked *checked)
{
    const bool is_stalled = hexagen_watch_stall(supervisor, limits, sample->hall, set_point);
    checked->i_a = hexagen_current(limits, sample->adc[0], supervisor->offset_a);
    checked->i_b = hexagen_current(limits, sample->adc[1], supervisor->offset_b);
    checked->hall = (int32_t)sample->hall;
    checked->hall_ticks = (int32_t)sample->hall_ticks;
    return supervisor->mode == HEXAGEN_MODE_RUN && !hexagen_is_at_end(limits, sample->adc[0])
        && !hexagen_is_at_end(limits, sample->adc[1]) && hexagen_is_hall_code(sample->hall)
        && !hexagen_is_over(limits, checked->i_a, checked->i_b) && !is_stalled;
}

/**
 * The supervisor of a drive that controls currents from its first period on, with nominal offsets.
 */
void hexagen_start(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/**
 * A period without control, behind a hexagen_check that said so: goes on with start-up, trips where
 * there is a fault, and says what all legs do. The checked sample has its counts held within the
 * ADC's range, and Hall code 0 where there was none.
 */
HEXAGEN_COLD hexagen_leg hexagen_rest(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample, hexagen_checked *checked);

/**
 * Clears a trip; keeps calibrated offsets. False, and nothing done, while calibrating and
 * pre-charging.
 */
bool hexagen_reset(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/** Starts calibration; ignored when tripped. */
void hexagen_calibrate(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/** Starts pre-charge; ignored when tripped, while calibrating, and where there is none. */
void hexagen_precharge(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/** Mode and fault in one word, as the control loop publishes them. */
static inline int32_t hexagen_status_word(const hexagen_supervisor *supervisor)
{
    return (int32_t)supervisor->mode | ((int32_t)supervisor->fault << 8);
}

/* ---- Bus voltage ------------------------------------------------------------------------- */

/**
 * A bus voltage that is told, as two words that are replaced as one, seen from other contexts of
 * the same core: two banks, of which one is published. A reader that interrupts a call gets the old
 * words whole.
 */
typedef struct {
    volatile int32_t banks[2][2];
    /** The bank that is read. */
    volatile int32_t published;
    /** Not 0: a call is at it, and has so many control periods left. */
    volatile int32_t storing;
    /** Not 0: a call took effect since the last control period. */
    volatile int32_t told;
    /** Control periods until the voltage is stale; the control loop's own. */
    volatile int32_t left;
} hexagen_bus;

/** Control periods after which a call that has not ended counts as given up. */
#define HEXAGEN_GIVEN_UP INT32_C(65536)

/** A voltage that was not told yet, with the nominal one's words. */
void hexagen_start_bus(hexagen_bus *bus, int32_t first, int32_t second);

/**
 * Replaces both words together. A call that interrupts another one has no effect; one that was
 * interrupted for good keeps later calls from having an effect for HEXAGEN_GIVEN_UP control
 * periods.
 */
void hexagen_tell_bus(hexagen_bus *bus, int32_t first, int32_t second);

/** The words last told. */
static inline const volatile int32_t *hexagen_bus_words(const hexagen_bus *bus)
{
    return bus->banks[(bus->published == 0) ? 0 : 1];
}

/**
 * A control period begins: the voltage is that much older, and so is a call that has not come to
 * its end. It is stale where `periods` of them pass without a call that takes effect.
 */
static inline void hexagen_pass_period(hexagen_bus *bus, int32_t periods)
{
    const int32_t storing = bus->storing;
    if (storing != 0) {
        bus->storing = storing - 1;
    }
    if (bus->told != 0) {
        bus->told = 0;
        bus->left = periods;
    } else {
        const int32_t left = bus->left;
        if (left != 0) {
            bus->left = left - 1;
        }
    }
}

/** Whether the voltage is stale, as of the last control period. */
static inline bool hexagen_bus_is_stale(const hexagen_bus *bus)
{
    return bus->left == 0;
}

/* ---- Signals for people ------------------------------------------------------------------ */

/** A word of what there is not. */
#define HEXAGEN_NONE INT32_MIN

/** What a law believes of the motor, in its own words; HEXAGEN_NONE of what it does not know. */
typedef struct {
    /** EMF of phases a and b, words of voltage. */
    int32_t e_a;
    int32_t e_b;
    /** Speed, forward positive; 0 while it is unknown. */
    int32_t speed;
} hexagen_observation;

/** The observation of a law that tells nothing. */
#define HEXAGEN_UNOBSERVED { HEXAGEN_NONE, HEXAGEN_NONE, HEXAGEN_NONE }

/*
 * Where HEXAGEN_SIGNALS is defined, for all files of a program alike: the look whether somebody
 * asks takes some ten instructions of every control period, and a drive 40 bytes more.
 */
#ifdef HEXAGEN_SIGNALS

/**
 * What a drive saw, believed and commanded in one control period: numbers with 16 fraction bits,
 * which saturate at 32768 to both sides.
 */
typedef struct {
    /** Currents of phases a, b, c into the motor at the begin of the period, ampere. */
    int32_t currents[3];
    /**
     * Mean terminal voltages that the period commands, for the next one with `delay: 1`, volt
     * against the negative rail at the nominal bus; 0 of a leg that is off.
     */
    int32_t voltages[3];
    /** Whether the legs are off. */
    bool is_off[3];
    /**
     * Whether the law works an EMF out, and that of phases a, b, c which it expects in the period
     * in which the command takes effect (PHCC: in the one that begins), volt; else 0.
     */
    bool has_emf;
    int32_t emf[3];
    /** Whether the law follows Hall edges, and the speed in rpm, forward positive; 0 if unknown. */
    bool has_speed;
    int32_t speed;
    /** Sector 1 to 6. */
    uint16_t sector;
} hexagen_signals;

/** What a word stands for: a factor with 16 fraction bits, times 2^shift; shift is 1 to 62. */
typedef struct {
    int32_t factor;
    uint16_t shift;
} hexagen_unit;

/** Units of what a drive tells of itself. */
typedef struct {
    /** Ampere per word of current. */
    hexagen_unit ampere;
    /** Volt per word of voltage. */
    hexagen_unit volt;
    /** Volt per timer count at the nominal bus. */
    hexagen_unit volt_per_count;
    /** Revolutions per minute per word of speed. */
    hexagen_unit rpm;
    /** Sector 1 to 6 by Hall code; 0 for codes that cannot be. */
    uint16_t sectors[8];
} hexagen_units;

/**
 * Where the words of a period go over. The control loop writes while it is asked, and at no other
 * time; the main program writes while it is not, and reads while it is answered. Neither side ever
 * waits for the other.
 */
typedef struct {
    /**
     * 0: nobody has asked. 1: the next controlled period's words are wanted. 2: they are there.
     * 3: they are being taken.
     */
    volatile int32_t turn;
    volatile int32_t words[9];
} hexagen_port;

/** A port at which nobody has asked. */
void hexagen_start_port(hexagen_port *port);

/** Whether the words of this period are wanted. */
static inline bool hexagen_is_asked(const hexagen_port *port)
{
    return port->turn == 1;
}

/** Answers with the words of this period; by value, so that they stand in memory on this path alone. */
HEXAGEN_COLD void hexagen_answer(hexagen_port *port, hexagen_checked checked, hexagen_legs legs,
    hexagen_observation observation);

/** The signals that are there; else asks for those of the next controlled period. */
bool hexagen_take(hexagen_port *port, const hexagen_units *units, hexagen_signals *signals);

#endif

/* ---- Verification ------------------------------------------------------------------------ */

#ifdef HEXAGEN_VERIFICATION
/** Words of a supervisor. */
#define HEXAGEN_WORDS 9

/**
 * Copies the words of a supervisor: mode, fault, countdown, sum_a, sum_b, offset_a, offset_b,
 * stall_count, hall_prev.
 */
void hexagen_words(const hexagen_supervisor *supervisor, int32_t *words);

/** Overwrites them with values inside their ranges. */
void hexagen_set_words(hexagen_supervisor *supervisor, const int32_t *words);
#endif

#ifdef __cplusplus
}
#endif

#endif
