/**
 * C99 runtime of hexagen's drives: samples and commands, supervision, arithmetic.
 *
 * Each motor and controller has its emitted files, `hub_drive.h` and `hub_drive.c`: constants,
 * tables and the control law. This header and `hexagen.c` are common to all drives of a program. A
 * compiler needs `stdbool.h`, `stdint.h`, and types of 16, 32 and 64 bits; none of 8, which some
 * cores lack. No signed number overflows, and no negative one is shifted.
 *
 * One context, the control interrupt, calls a drive's `step`; `init`, `reset`, `calibrate` and
 * `precharge` belong to it or run while it does not. All other contexts of the same core may call
 * setters, `status` and `signals`. Words shared between contexts are `volatile int32_t`, which
 * 32-bit cores and a C2000 load and store in one instruction; where that takes several, mask the
 * interrupt around these calls.
 */
#ifndef HEXAGEN_H
#define HEXAGEN_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Version of this interface. Drives refuse to compile with a header of another version. */
#define HEXAGEN_ABI 7

/** A function off the normal path, not to be inlined into it. */
#if defined(__GNUC__) || defined(__clang__)
#define HEXAGEN_COLD __attribute__((cold, noinline))
#else
#define HEXAGEN_COLD
#endif

/* ---- Samples and commands ---------------------------------------------------------------- */

/** Measurements at the beginning of a control period, as the hardware gives them. */
typedef struct {
    /** ADC counts of the currents of phases a, b, c; ignored where there is no sensor. */
    uint16_t adc[3];
    /** Hall code `Ha Hb Hc`, Ha in bit 2; 0 where there is an angle. */
    uint16_t hall;
    /** Timer ticks from the last Hall edge to this sample, stopping at 65535. */
    uint16_t hall_ticks;
    /** Angle of a sensor, 2^32 a turn; 0 where there is a Hall code. */
    uint32_t angle;
} hexagen_sample;

/**
 * ADC counts of phases a and b, and a Hall code. Any code is accepted: one that Hall sensors cannot
 * give (0, 7 and above) trips the drive.
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
 * ADC counts of phases a and b, and the angle of a sensor, 2^32 per turn of it, for drives with
 * `rotor: angle`; their specification says what it has to do with the electrical angle. It has no
 * Hall code: a drive that needs one trips.
 */
static inline hexagen_sample hexagen_with_angle(uint16_t adc_a, uint16_t adc_b, uint32_t angle)
{
    hexagen_sample sample = hexagen_with_hall(adc_a, adc_b, 0);
    sample.angle = angle;
    return sample;
}

/**
 * The sample with the electrical angle, given the electrical turns in a turn of the sensor, negative
 * where its angle falls in forward rotation, and the electrical angle at its angle 0; and with the
 * Hall code that sensors would show there, to a resolution of 2^-16 of a turn. A sample with a Hall
 * code has no angle: it gets a code that no sensors give, and trips the drive.
 */
static inline hexagen_sample hexagen_resolve_angle(
    const hexagen_sample *sample, int32_t turns, uint32_t offset)
{
    /* Hall codes of sectors 1 to 6, four bits each; sector 1 begins half a sector before angle 0. */
    const uint32_t codes = UINT32_C(0x00326451);
    hexagen_sample resolved = *sample;
    uint32_t sector;
    resolved.angle = sample->angle * (uint32_t)turns + offset;
    sector = (((resolved.angle + UINT32_C(357913942)) >> 16) * 6U) >> 16;
    resolved.hall = (uint16_t)(sample->hall == 0U ? (codes >> (4U * sector)) & 7U : 7U);
    return resolved;
}

/**
 * The same sample with the time since the last Hall edge, for drives with `hall_capture: timer`.
 *
 * Code and ticks must belong together: latch both in the capture interrupt, or read the ticks, the
 * code, and the ticks again, until the second count is not below the first.
 */
static inline hexagen_sample hexagen_with_ticks(hexagen_sample sample, uint16_t hall_ticks)
{
    sample.hall_ticks = hall_ticks;
    return sample;
}

/** The same sample with the ADC count of phase c, for drives with a current sensor there. */
static inline hexagen_sample hexagen_with_third(hexagen_sample sample, uint16_t adc_c)
{
    sample.adc[2] = adc_c;
    return sample;
}

/** State of an inverter leg, for a whole period or one of its intervals. */
typedef enum {
    /**
     * In hexagen_legs: both switches follow the timer channel (complementary outputs). In
     * hexagen_intervals: the upper switch is on throughout the interval.
     */
    HEXAGEN_LEG_PULSED = 0,
    /** The lower switch is on throughout, the upper one off. */
    HEXAGEN_LEG_LOW = 1,
    /** Both switches are off: the leg floats or its diodes conduct. */
    HEXAGEN_LEG_OFF = 2
} hexagen_leg;

/** The state with this number: 0 pulsed, 1 low, else off. */
static inline hexagen_leg hexagen_leg_of(int32_t number)
{
    return (number == 0) ? HEXAGEN_LEG_PULSED : (number == 1) ? HEXAGEN_LEG_LOW : HEXAGEN_LEG_OFF;
}

/**
 * Compare values for a centre-aligned timer and a state per leg, for legs a, b, c.
 *
 * A compare value is the time for which the upper switch is on, timer counts from 0 to the timer's
 * period. It is 0 for a leg that is not pulsed.
 */
typedef struct {
    uint16_t compare[3];
    hexagen_leg state[3];
} hexagen_legs;

/** All legs in the same state, without pulses. */
static inline hexagen_legs hexagen_all_legs(hexagen_leg state)
{
    const hexagen_legs legs = { { 0, 0, 0 }, { state, state, state } };
    return legs;
}

/**
 * Three intervals of each PWM period with a state per leg each, for modulators that turn legs off and
 * on within a period; the timer changes output modes and enables by compare events.
 *
 * The first two end at an instant, 0 to TIMER_PERIOD counts behind the beginning of the PWM period, the
 * second not before the first; the third ends with the period. One count is 1/TIMER_PERIOD of the PWM
 * period: two clocks of a centre-aligned timer. States are those of legs a, b, c in two bits each, a's
 * lowest, as of hexagen_leg: an index for a table of outputs. The third interval is a zero vector.
 */
typedef struct {
    uint16_t end[2];
    uint16_t states[3];
} hexagen_intervals;

/** All legs in the same state for the whole period. */
static inline hexagen_intervals hexagen_all_intervals(hexagen_leg state)
{
    const uint16_t states = (uint16_t)((uint32_t)state * 21U);
    const hexagen_intervals intervals = { { 0, 0 }, { states, states, states } };
    return intervals;
}

/** State of a leg, 0 a to 2 c, in an interval, 0 to 2. */
static inline hexagen_leg hexagen_leg_in(
    hexagen_intervals intervals, uint16_t interval, uint16_t leg)
{
    return hexagen_leg_of((int32_t)(((uint32_t)intervals.states[interval] >> (2U * leg)) & 3U));
}

/* ---- Status ------------------------------------------------------------------------------ */

/** Operating mode of a drive. */
typedef enum {
    /** Current control. */
    HEXAGEN_MODE_RUN = 0,
    /** Averaging the current offsets, all legs off. */
    HEXAGEN_MODE_CALIBRATE = 1,
    /** Charging the bootstrap capacitors, all lower switches on. */
    HEXAGEN_MODE_PRECHARGE = 2,
    /** Tripped, all legs off, until `reset`. */
    HEXAGEN_MODE_TRIPPED = 3,
    /** All legs off on purpose, until `resume`. */
    HEXAGEN_MODE_COAST = 4,
    /** Slowing the rotor down, until `resume`. */
    HEXAGEN_MODE_BRAKE = 5,
    /** All legs off until the rotor's angle is known, or the rotor known to be slow; control follows. */
    HEXAGEN_MODE_START = 6
} hexagen_mode;

/** Cause of a trip. If one control period has several, the first of this list is reported. */
typedef enum {
    /** Not tripped. */
    HEXAGEN_FAULT_NONE = 0,
    /** The bus voltage that `set_bus` told was above `over_voltage`. */
    HEXAGEN_FAULT_OVER_VOLTAGE = 6,
    /** The bus voltage that `set_bus` told was below `under_voltage`. */
    HEXAGEN_FAULT_UNDER_VOLTAGE = 7,
    /**
     * The currents did not follow the voltages for the `residual_timeout` longer than they did: a dead
     * current sensor, an open or exchanged phase, a sensor's wrong sign, or wrong motor data.
     */
    HEXAGEN_FAULT_RESIDUAL = 8,
    /**
     * Over seven Hall edges in a row the rotor turned faster than `over_speed`: a shaft that is driven,
     * a load that was lost, or a speed loop with wrong gains.
     */
    HEXAGEN_FAULT_OVER_SPEED = 10,
    /**
     * The currents of three sensors did not add up in so many samples in a row as the specification
     * says, `current_sum_samples`: a dead or wrong sensor, or a current that leaves the motor.
     */
    HEXAGEN_FAULT_CURRENT_SUM = 9,
    /** A current ADC was at an end of its range: count 0, the largest count, or more. */
    HEXAGEN_FAULT_ADC_RANGE = 1,
    /**
     * The Hall code was one that no sensors give (000, 111 or above; with sensors 60 degrees apart 010
     * and 101 or others), or disturbed in more samples in a row than `hall_glitches`.
     */
    HEXAGEN_FAULT_HALL = 3,
    /** A phase current was above the trip level. */
    HEXAGEN_FAULT_OVER_CURRENT = 2,
    /** No Hall edge within the stall time-out while the set-point was not 0. */
    HEXAGEN_FAULT_STALL = 4,
    /** A calibrated current offset was too far from its nominal value. */
    HEXAGEN_FAULT_OFFSET = 5
} hexagen_fault;

/** Mode and fault of a drive, as of the end of the last control period or call. */
typedef struct {
    hexagen_mode mode;
    hexagen_fault fault;
    /**
     * `v_bus: measured`: no call of `set_bus` took effect for 100 ms, so the controller uses an old
     * voltage; before the first call, the nominal one. A warning, which trips nothing. Never set
     * with `v_bus: fixed`.
     */
    bool bus_is_stale;
    /**
     * Samples with a disturbed Hall code that were bridged since the drive was initialised or reset,
     * at most 32,767; 0 unless the specification has `hall_glitches`.
     */
    uint16_t hall_glitches;
} hexagen_status;

/**
 * Unpacks the status word of the control loop: mode in the lower 8 bits, then 8 bits of the fault,
 * bridged samples above.
 */
static inline hexagen_status hexagen_status_of(int32_t word, bool bus_is_stale)
{
    hexagen_status status;
    status.mode = (hexagen_mode)(word & 0xff);
    status.fault = (hexagen_fault)((word >> 8) & 0xff);
    status.bus_is_stale = bus_is_stale;
    status.hall_glitches = (uint16_t)((uint32_t)word >> 16);
    return status;
}

/* ---- Arithmetic -------------------------------------------------------------------------- */

/**
 * The word with these bits: int32_t is two's complement by C99. Without a branch, because gcc 12
 * loses the sum of a branch on its sign on cores with Thumb-1 alone.
 */
static inline int32_t hexagen_wrap(uint32_t bits)
{
    union {
        uint32_t bits;
        int32_t word;
    } same;
    same.bits = bits;
    return same.word;
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

/** floor(x / 2^shift) as a word; the quotient must fit. */
static inline int32_t hexagen_shift_right_wide(int64_t x, uint16_t shift)
{
    return (int32_t)((x >= 0) ? (x >> shift) : ~(~x >> shift));
}

/** Sum of two angles; wraps, as a turn is 2^32. */
static inline int32_t hexagen_angle_add(int32_t a, int32_t b)
{
    return hexagen_wrap((uint32_t)a + (uint32_t)b);
}

/** Difference of two angles; wraps, as a turn is 2^32. */
static inline int32_t hexagen_angle_sub(int32_t a, int32_t b)
{
    return hexagen_wrap((uint32_t)a - (uint32_t)b);
}

/** |x| */
static inline int32_t hexagen_abs(int32_t x)
{
    return (x < 0) ? -x : x;
}

/** Minimum. */
static inline int32_t hexagen_min(int32_t a, int32_t b)
{
    return (a < b) ? a : b;
}

/** Maximum. */
static inline int32_t hexagen_max(int32_t a, int32_t b)
{
    return (a > b) ? a : b;
}

/** Clamps to `low` to `high`. */
static inline int32_t hexagen_clamp(int32_t x, int32_t low, int32_t high)
{
    return hexagen_min(hexagen_max(x, low), high);
}

/** Whether |x| > limit, which is not negative. */
static inline bool hexagen_exceeds(int32_t x, int32_t limit)
{
    return (uint32_t)x + (uint32_t)limit > UINT32_C(2) * (uint32_t)limit;
}

/** Whether the core has no instruction for a 64-bit product. */
#if defined(__ARM_ARCH_6M__) || defined(__ARM_ARCH_8M_BASE__)
enum { HEXAGEN_BY_HALVES = 1 };
#else
enum { HEXAGEN_BY_HALVES = 0 };
#endif

/** floor(a b / 2^32) from 32-bit products of half words: a third of the library function's instructions. */
static inline int32_t hexagen_upper_by_halves(int32_t a, int32_t b)
{
    const int32_t a_upper = hexagen_shift_right(a, 16U), b_upper = hexagen_shift_right(b, 16U);
    const uint32_t a_lower = (uint32_t)a & 0xffffU, b_lower = (uint32_t)b & 0xffffU;
    const int32_t crossed = a_upper * (int32_t)b_lower + (int32_t)((a_lower * b_lower) >> 16);
    const int32_t rest = (int32_t)((uint32_t)crossed & 0xffffU);
    return a_upper * b_upper + hexagen_shift_right(crossed, 16U)
        + hexagen_shift_right((int32_t)a_lower * b_upper + rest, 16U);
}

/** The lower word of a b. */
static inline uint32_t hexagen_lower_product(int32_t a, int32_t b)
{
    return (uint32_t)a * (uint32_t)b;
}

/** a b */
static inline int64_t hexagen_product(int32_t a, int32_t b)
{
    if (HEXAGEN_BY_HALVES) {
        return hexagen_upper_by_halves(a, b) * INT64_C(4294967296) + hexagen_lower_product(a, b);
    }
    return (int64_t)a * b;
}

/** floor((coefficient signal + 2^(shift-1)) / 2^shift): rounded half up. */
static inline int32_t hexagen_mul_round(int32_t coefficient, int32_t signal, uint16_t shift)
{
    const int64_t half = INT64_C(1) << (shift - 1);
    if (HEXAGEN_BY_HALVES && shift == 32U) {
        return hexagen_upper_by_halves(coefficient, signal)
            + (int32_t)(hexagen_lower_product(coefficient, signal) >> 31);
    }
    return hexagen_shift_right_wide(hexagen_product(coefficient, signal) + half, shift);
}

/** Like hexagen_mul_round, for products that fit a word including their rounding. */
static inline int32_t hexagen_mul_round_narrow(int32_t coefficient, int32_t signal, uint16_t shift)
{
    return hexagen_shift_right(coefficient * signal + (INT32_C(1) << (shift - 1)), shift);
}

/** floor(a b / 2^shift) */
static inline int32_t hexagen_mul_floor(int32_t a, int32_t b, uint16_t shift)
{
    if (HEXAGEN_BY_HALVES && shift == 32U) {
        return hexagen_upper_by_halves(a, b);
    }
    return hexagen_shift_right_wide(hexagen_product(a, b), shift);
}

/** floor((a b + c d) / 2^shift) for a sum that fits 64 bits. */
static inline int32_t hexagen_mul_add_floor(
    int32_t a, int32_t b, int32_t c, int32_t d, uint16_t shift)
{
    if (HEXAGEN_BY_HALVES && shift == 32U) {
        const uint32_t lower = hexagen_lower_product(a, b);
        const bool carries = lower + hexagen_lower_product(c, d) < lower;
        return hexagen_upper_by_halves(a, b) + hexagen_upper_by_halves(c, d) + (carries ? 1 : 0);
    }
    return hexagen_shift_right_wide(hexagen_product(a, b) + hexagen_product(c, d), shift);
}

/** min(a b, limit) for non-negative factors; the product may exceed the word. */
static inline int32_t hexagen_mul_limited(int32_t a, int32_t b, int32_t limit)
{
    const int64_t product = hexagen_product(a, b);
    return (product < limit) ? (int32_t)product : limit;
}

/**
 * min(floor(numerator 2^shift / denominator), limit) for a non-negative numerator and limit, and a
 * denominator of at least 1. For use off the normal path.
 */
int32_t hexagen_divide(int32_t numerator, int32_t denominator, int32_t limit, uint16_t shift);

/** Like hexagen_divide, for a shifted numerator that fits 32 bits. */
static inline int32_t hexagen_divide_narrow(
    int32_t numerator, int32_t denominator, int32_t limit, uint16_t shift)
{
    const uint32_t quotient = ((uint32_t)numerator << shift) / (uint32_t)denominator;
    return (quotient < (uint32_t)limit) ? (int32_t)quotient : limit;
}

/** x - 2^bits floor(x / 2^bits): what a shift by `bits`, 1 to 30, leaves over. */
static inline int32_t hexagen_remainder(int32_t x, uint16_t bits)
{
    return (int32_t)((uint32_t)x & ((UINT32_C(1) << bits) - 1U));
}

/** floor((2^32 - 1) / ticks): angle per tick if a turn, 2^32, lasts `ticks`, at least 2. */
static inline int32_t hexagen_turn_over(int32_t ticks)
{
    return (int32_t)(UINT32_C(0xffffffff) / (uint32_t)ticks);
}

/** hexagen_angle_index from products of half words; at most 65536 segments. */
static inline int32_t hexagen_angle_index_by_halves(int32_t angle, uint32_t segments)
{
    const uint32_t upper = (uint32_t)angle >> 16, lower = (uint32_t)angle & 0xffffU;
    return (int32_t)((upper * segments + ((lower * segments) >> 16)) >> 16);
}

/** Index, from 0, of the one of `segments` equal parts of a turn that contains the angle. */
static inline int32_t hexagen_angle_index(int32_t angle, uint32_t segments)
{
    if (HEXAGEN_BY_HALVES) {
        return hexagen_angle_index_by_halves(angle, segments);
    }
    return (int32_t)(((uint64_t)(uint32_t)angle * segments) >> 32);
}

/** Position within that part from its middle; its width is 2^32. */
static inline int32_t hexagen_angle_fraction(int32_t angle, uint32_t segments)
{
    return hexagen_wrap(((uint32_t)angle * segments) ^ UINT32_C(0x80000000));
}

/**
 * A torque, a number with 16 fraction bits, times a ratio with 28 fraction bits, at most 1.5: stated over
 * learnt torque constant. The torque saturates at 16384 Nm.
 */
int32_t hexagen_scaled_torque(int32_t bits, int32_t ratio);

/** A word that the control loop writes, read from another context. */
static inline int32_t hexagen_shared(const int32_t *word)
{
    return *(const volatile int32_t *)word;
}

/** Learnt over stated torque constant, with 16 fraction bits, of the inverse ratio with 28. */
int32_t hexagen_torque_constant_ratio(int32_t ratio);

/**
 * Displacements of three sensors in degrees with 16 fraction bits, from those of the first and the second and of all,
 * 2^32 a turn; that of the third is minus the sum of the first two, and the one between the others counts as 0.
 */
void hexagen_hall_offsets(int32_t first, int32_t second, int32_t all, int32_t degrees[3]);

/** Thousandths as a number with 16 fraction bits, rounded to the nearest; saturates. */
int32_t hexagen_thousandths(int32_t number);

/** An integer as a number with 16 fraction bits; saturates. */
int32_t hexagen_whole(int32_t number);

/* ---- Supervision ------------------------------------------------------------------------- */

/**
 * The phases of the first and the second current sensor. The third phase has the rest of their
 * currents, unless it has a sensor, too.
 */
typedef enum { HEXAGEN_SENSED_AB = 0, HEXAGEN_SENSED_BC = 1, HEXAGEN_SENSED_CA = 2 } hexagen_sensed;

/** Fraction bits of the ratio of two sensors' gains, and the ratio of equal ones. */
#define HEXAGEN_RATIO_BITS 15U
#define HEXAGEN_ALIKE INT32_C(0x8000)

/** Sign, gain and offset of a current sensor. */
typedef struct {
    /** Whether counts fall with the current into the motor. */
    bool inverted;
    /** ADC count at zero current before calibration. */
    uint16_t offset;
    /** Least and greatest offset that calibration accepts, counts. */
    uint16_t offset_least;
    uint16_t offset_most;
    /** Current of a count over that of the first sensor, with HEXAGEN_RATIO_BITS: 1/2 to 2. */
    int32_t ratio;
} hexagen_sensor;

/**
 * What a drive makes of three current sensors.
 *
 * Sensors in the low legs show the currents of legs that are low for long enough. Of three, at least
 * two are: the leg that is high for longest, or is off, is the one that may not be read; its current
 * is the rest of the other two.
 */
typedef struct {
    /** Whether there is a third sensor. */
    bool is_there;
    /** Whether the sensors are in the low legs. */
    bool is_low_side;
    /** Largest compare value of a leg that is read at the end of the period. */
    uint16_t readable;
    /** Whether a command takes effect one period after the sample that it comes from. */
    bool is_delayed;
    /** Where all three are read, the largest sum of their currents without a fault, words of current. */
    int32_t sum_tolerance;
    /**
     * Samples in a row with a larger sum, of those in which all three are read, that trip the drive; 0
     * for none.
     */
    uint16_t sum_samples;
} hexagen_third_sensor;

/**
 * Limits of a drive's samples, and its start-up times. Words of current are ADC counts with
 * `current_bits` fraction bits.
 */
typedef struct {
    /** Largest count of the current ADC. */
    uint16_t adc_max;
    /** Fraction bits of words of current. */
    uint16_t current_bits;
    /** The phases of the first two sensors. */
    hexagen_sensed sensed;
    /** The sensors; a third that is not there is like the second. */
    hexagen_sensor sensors[3];
    /** What is made of the third. */
    hexagen_third_sensor third;
    /** Trip level, words of current: a phase current above it trips. */
    int32_t trip;
    /** Least and greatest current over all counts and accepted offsets, words of current. */
    int32_t current_least;
    int32_t current_most;
    /** Base-2 logarithm of the number of calibration samples. */
    uint16_t calibration_log2;
    /** Control periods of bootstrap pre-charge; 0 for none. */
    uint16_t precharge_periods;
    /**
     * Stall time-out: control periods without a Hall edge under demand; 0 for no stall detection.
     */
    int32_t stall_periods;
    /**
     * Hall sensors whose signal is inverted before anything else, as bits of the code: one of three
     * sensors that stand 60 degrees apart. With them the codes are 001 to 110.
     */
    uint16_t hall_inverted;
    /** Samples in a row with a disturbed Hall code that are bridged; 0 for none. */
    uint16_t hall_glitches;
    /** Sector 1 to 6 by Hall code, four bits each, code 0 lowest; 0 of an invalid code. */
    uint32_t sectors;
    /**
     * Control periods of a sector at the speed up to which the short-circuited motor takes no more
     * than the largest current; 0 if it never takes more.
     */
    int32_t brake_periods;
    /**
     * Control periods that a start waits at most for the rotor's angle: two sectors at the speed up
     * to which control may begin without it; 0 for none.
     */
    uint16_t start_periods;
    /** Least and greatest ADC count of the bus voltage without a fault; 0 and 65535 for none. */
    uint16_t bus_least;
    uint16_t bus_most;
} hexagen_limits;

/**
 * Defines constant limits with this name, of two sensors alike in phases a and b. Does not compile
 * if they contradict each other, or if a sum or a current does not fit 32 bits.
 */
#define HEXAGEN_LIMITS(name, adc_max, adc_inverted, current_bits, offset, offset_least, \
    offset_most, trip, current_least, current_most, calibration_log2, precharge_periods, \
    stall_periods, hall_inverted, hall_glitches, sectors, brake_periods, start_periods, bus_least, bus_most) \
    HEXAGEN_LIMITS_OF(name, adc_max, adc_inverted, current_bits, offset, offset_least, \
        offset_most, trip, current_least, current_most, calibration_log2, precharge_periods, \
        stall_periods, hall_inverted, hall_glitches, sectors, brake_periods, start_periods, bus_least, bus_most, \
        HEXAGEN_SENSED_AB, adc_inverted, offset, offset_least, offset_most, HEXAGEN_ALIKE)

/** The same for any two sensors: the first one's sign and offset, then phases and the second. */
#define HEXAGEN_LIMITS_OF(name, adc_max, adc_inverted, current_bits, offset, offset_least, \
    offset_most, trip, current_least, current_most, calibration_log2, precharge_periods, \
    stall_periods, hall_inverted, hall_glitches, sectors, brake_periods, start_periods, bus_least, bus_most, \
    sensed, second_inverted, second_offset, second_least, second_most, second_ratio) \
    HEXAGEN_LIMITS_OF_THREE(name, adc_max, adc_inverted, current_bits, offset, offset_least, \
        offset_most, trip, current_least, current_most, calibration_log2, precharge_periods, \
        stall_periods, hall_inverted, hall_glitches, sectors, brake_periods, start_periods, bus_least, bus_most, \
        sensed, second_inverted, second_offset, second_least, second_most, second_ratio, \
        second_inverted, second_offset, second_least, second_most, second_ratio, \
        false, false, 0, false, 0, 0)

/** The same for three sensors: then the third, and what is made of it. */
#define HEXAGEN_LIMITS_OF_THREE(name, adc_max, adc_inverted, current_bits, offset, offset_least, \
    offset_most, trip, current_least, current_most, calibration_log2, precharge_periods, \
    stall_periods, hall_inverted, hall_glitches, sectors, brake_periods, start_periods, bus_least, bus_most, \
    sensed, second_inverted, second_offset, second_least, second_most, second_ratio, \
    third_inverted, third_offset, third_least, third_most, third_ratio, \
    has_third, is_low_side, readable, is_delayed, sum_tolerance, sum_samples) \
    typedef int name##_hold[HEXAGEN_LIMITS_HOLD((int64_t)(adc_max), current_bits, trip, \
        (int64_t)(current_least), (int64_t)(current_most), calibration_log2, stall_periods, \
        brake_periods, has_third) \
        && HEXAGEN_SENSOR_HOLDS((int64_t)(adc_max), offset, offset_least, offset_most, HEXAGEN_ALIKE) \
        && HEXAGEN_SENSOR_HOLDS((int64_t)(adc_max), second_offset, second_least, second_most, second_ratio) \
        && HEXAGEN_SENSOR_HOLDS((int64_t)(adc_max), third_offset, third_least, third_most, third_ratio) \
        && (int64_t)(current_least) == HEXAGEN_LESSER( \
            HEXAGEN_LEAST((int64_t)(adc_max), adc_inverted, current_bits, (int64_t)(offset_most), \
                (int64_t)(offset_least), HEXAGEN_ALIKE), \
            HEXAGEN_LESSER(HEXAGEN_LEAST((int64_t)(adc_max), second_inverted, current_bits, \
                (int64_t)(second_most), (int64_t)(second_least), second_ratio), \
            HEXAGEN_LEAST((int64_t)(adc_max), third_inverted, current_bits, \
                (int64_t)(third_most), (int64_t)(third_least), third_ratio))) \
        && -(int64_t)(current_most) == HEXAGEN_LESSER( \
            -HEXAGEN_MOST((int64_t)(adc_max), adc_inverted, current_bits, (int64_t)(offset_most), \
                (int64_t)(offset_least), HEXAGEN_ALIKE), \
            HEXAGEN_LESSER(-HEXAGEN_MOST((int64_t)(adc_max), second_inverted, current_bits, \
                (int64_t)(second_most), (int64_t)(second_least), second_ratio), \
            -HEXAGEN_MOST((int64_t)(adc_max), third_inverted, current_bits, \
                (int64_t)(third_most), (int64_t)(third_least), third_ratio))) \
        && (((sensed) == HEXAGEN_SENSED_AB && !(has_third)) \
            || ((trip) <= (current_most) && -(int64_t)(trip) >= (current_least))) \
        && ((sensed) == HEXAGEN_SENSED_AB || !(has_third)) && (sum_tolerance) >= 0 \
        ? 1 : -1]; \
    static const hexagen_limits name = { adc_max, current_bits, sensed, \
        { { adc_inverted, offset, offset_least, offset_most, HEXAGEN_ALIKE }, \
            { second_inverted, second_offset, second_least, second_most, second_ratio }, \
            { third_inverted, third_offset, third_least, third_most, third_ratio } }, \
        { has_third, is_low_side, readable, is_delayed, sum_tolerance, sum_samples }, \
        trip, current_least, current_most, calibration_log2, precharge_periods, stall_periods, \
        hall_inverted, hall_glitches, sectors, brake_periods, start_periods, bus_least, bus_most }

/**
 * Whether limits are valid, but for their sensors; the phase that is not read has the negative sum
 * of two currents, and three are added, too. A law takes its current, within the trip level, where it
 * is that of a or b.
 */
#define HEXAGEN_LIMITS_HOLD(adc_max, bits, trip, low, high, log2, stall, brake, has_third) \
    ((bits) < 31 && (log2) < 16 && (adc_max) > 1 && (trip) > 0 && (stall) >= 0 \
        && (stall) < INT32_C(0x7fffffff) && (brake) >= 0 && (brake) < INT32_C(0x7fffffff) \
        && ((has_third) ? -3 : -2) * (low) <= INT64_C(0x7fffffff) \
        && ((has_third) ? 3 : 2) * (high) <= INT64_C(0x7fffffff) \
        && (adc_max) * (INT64_C(1) << ((log2) & 15)) <= INT64_C(0x7fffffff))

#define HEXAGEN_SENSOR_HOLDS(adc_max, offset, least, most, ratio) \
    ((least) <= (offset) && (offset) <= (most) && (most) <= (adc_max) \
        && (ratio) >= HEXAGEN_ALIKE / 2 && (ratio) <= 2 * HEXAGEN_ALIKE)

#define HEXAGEN_LESSER(x, y) ((x) < (y) ? (x) : (y))

#define HEXAGEN_LEAST(adc_max, inverted, bits, most, least, ratio) \
    HEXAGEN_SCALED(((inverted) ? (least) - (adc_max) : -(most)) * (INT64_C(1) << ((bits) & 31)), ratio)

#define HEXAGEN_MOST(adc_max, inverted, bits, most, least, ratio) \
    HEXAGEN_SCALED(((inverted) ? (most) : (adc_max) - (least)) * (INT64_C(1) << ((bits) & 31)), ratio)

/** A sensor's current of the first sensor's gain, rounded half up; a division of positive numbers. */
#define HEXAGEN_SCALED(current, ratio) \
    (((current) * (ratio) + HEXAGEN_ALIKE / 2 + (INT64_C(1) << 60)) / HEXAGEN_ALIKE \
        - (INT64_C(1) << 60) / HEXAGEN_ALIKE)

/**
 * The supervisor of a drive: mode, first fault, offsets of the current ADCs.
 *
 * It trips on what samples show: a current above the trip level (but in calibration), a current ADC
 * at an end of its range, an invalid Hall code, and where told to, a rotor that stands or turns too fast; and on a
 * bus voltage that `set_bus` tells. It cannot see the following; where an option helps, it is named:
 *
 * - a current ADC or amplifier that is stuck or wrong within its range: one that is frozen at
 *   mid-scale can let the true current rise to several times the trip level. The option
 *   `residual_timeout` notices many of these, after its time (HEXAGEN_FAULT_RESIDUAL);
 * - the current of the phase that is not read: it is taken as the negative sum of the other two. With
 *   three sensors (`sensed_phases: abc`) the sum of all three is watched where all are read
 *   (HEXAGEN_FAULT_CURRENT_SUM);
 * - a control interrupt that does not come: the last command stands;
 * - heat, shoot-through, and what is shorter than a control period;
 * - a bus voltage that nobody measures, or that rises between two calls of `set_bus`.
 *
 * So the board must have (a) a comparator of the current on the timer's break input, (b) a watchdog
 * on the control interrupt and (c) a thermal limit; where the motor can brake, a limit of the bus
 * voltage, too: with all legs off the diodes still pass an EMF above the bus on to it.
 *
 * A Hall code is disturbed if no sensors give it, and with `hall_glitches` also if it is not that of
 * the last sector or of one beside it. So many samples in a row with such a code are bridged: the
 * drive goes on as if the last code had stayed, and counts them in its status; one more is a fault.
 * Without `hall_glitches` a code that no sensors give is a fault at once, and one that skips sectors
 * is none.
 */
typedef struct {
    hexagen_mode mode;
    hexagen_fault fault;
    /** Periods left in calibration, pre-charge or start. */
    uint16_t countdown;
    /**
     * Last Hall code that was not disturbed, if stalls are detected or codes bridged; 0 before the
     * first.
     */
    uint16_t hall_prev;
    /** Samples since then, bridged, and all that were, at most HEXAGEN_MOST_GLITCHES. */
    uint16_t hall_gap;
    uint16_t hall_glitches;
    /** Periods under demand since the last Hall edge. */
    int32_t stall_count;
    /** Sums of calibration samples of the sensors, counts; 0 of a third that is not there. */
    int32_t sum[3];
    /** Their offsets, words of current. */
    int32_t offset[3];
    /** Samples in a row whose three currents do not add up. */
    uint16_t sum_count;
    /**
     * With three sensors in the low legs: in two bits each, the leg that the command of the period
     * that ends leaves unread, and with a delay that of the next period's; 0 to 2, or 3 for none.
     */
    uint16_t unread;
    /**
     * Rotation since control ended or the drive was made: Hall code of the last period, 0 before the
     * first.
     */
    uint16_t turn_hall;
    /**
     * Control periods since the last edge that is not one back over the edge before it: a sensor that
     * chatters moves no rotor.
     */
    int32_t turn_age;
    /**
     * Control periods between two edges, the last one of them the second in a row in its direction; 0
     * if the last edge is not.
     */
    int32_t turn_interval;
    /**
     * Of the last edge, 1 forward, -1 backward; 0 before the first and behind one that skips sectors.
     */
    int32_t turn_direction;
} hexagen_supervisor;

/**
 * A sample that has passed the supervisor: the input of a law. Only hexagen_check and hexagen_examine
 * make one; its currents lie within `current_least` and `current_most` of the limits.
 */
typedef struct {
    /** Currents of phases a and b into the motor, words of current. */
    int32_t i_a;
    int32_t i_b;
    /** Hall code, 1 to 6; 0 only at rest, if it was invalid. */
    int32_t hall;
    /** Ticks since the last Hall edge, 0 to 65535. */
    int32_t hall_ticks;
    /** Electrical angle, 2^32 a turn; of a drive with Hall sensors without meaning. */
    int32_t angle;
} hexagen_checked;

/** The count of a sensor, 0 to 2 for the first to the third. */
static inline uint16_t hexagen_count(
    const hexagen_limits *limits, const hexagen_sample *sample, uint16_t sensor)
{
    const uint16_t first = (limits->sensed == HEXAGEN_SENSED_AB) ? 0U
        : (limits->sensed == HEXAGEN_SENSED_BC)                  ? 1U
                                                                 : 2U;
    const uint16_t place = (uint16_t)(first + sensor);
    /* A remainder would be a division, which small cores do not have. */
    return sample->adc[(place < 3U) ? place : place - 3U];
}

/** The same, clamped to the ADC's range. */
static inline uint16_t hexagen_count_within(
    const hexagen_limits *limits, const hexagen_sample *sample, uint16_t sensor)
{
    const uint16_t read = hexagen_count(limits, sample, sensor);
    return (read < limits->adc_max) ? read : limits->adc_max;
}

/** A sensor's phase current in words of current; `offset` is a word of current, too. */
static inline int32_t hexagen_current(
    const hexagen_limits *limits, uint16_t sensor, uint16_t count, int32_t offset)
{
    const uint32_t word = (uint32_t)count << limits->current_bits;
    const uint32_t zero = (uint32_t)offset;
    const int32_t current =
        hexagen_wrap(limits->sensors[sensor].inverted ? zero - word : word - zero);
    return (limits->sensors[sensor].ratio == HEXAGEN_ALIKE)
        ? current
        : hexagen_mul_round(limits->sensors[sensor].ratio, current, HEXAGEN_RATIO_BITS);
}

/** Current of the phase that is not read. */
static inline int32_t hexagen_third(int32_t first, int32_t second)
{
    return hexagen_wrap(UINT32_C(0) - ((uint32_t)first + (uint32_t)second));
}

/** The currents of phases a and b, from the sensed ones and that of the third phase. */
static inline void hexagen_take_currents(const hexagen_limits *limits, hexagen_checked *checked,
    int32_t first, int32_t second, int32_t third)
{
    checked->i_a = (limits->sensed == HEXAGEN_SENSED_AB) ? first
        : (limits->sensed == HEXAGEN_SENSED_BC)          ? third
                                                         : second;
    checked->i_b = (limits->sensed == HEXAGEN_SENSED_AB) ? second
        : (limits->sensed == HEXAGEN_SENSED_BC)          ? first
                                                         : third;
}

/** Whether an ADC is at an end of its range: count 0, the largest, or more. */
static inline bool hexagen_is_at_end(const hexagen_limits *limits, uint16_t count)
{
    return count == 0U || count >= limits->adc_max;
}

/** The Hall code of a sample, of which no sensor is inverted any more. */
static inline uint16_t hexagen_hall_of(const hexagen_limits *limits, const hexagen_sample *sample)
{
    return (uint16_t)(sample->hall ^ limits->hall_inverted);
}

/** Whether the Hall code is valid: 001 to 110. */
static inline bool hexagen_is_hall_code(uint16_t hall)
{
    return hall >= 1U && hall <= 6U;
}

/** No leg is left unread. */
#define HEXAGEN_ALL_READ 3U

/** The leg that the sample does not show, 0 to 2, or HEXAGEN_ALL_READ. */
static inline uint16_t hexagen_unread(
    const hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    if (!limits->third.is_there) {
        return 2U;
    }
    return limits->third.is_low_side ? (uint16_t)(supervisor->unread & 3U) : HEXAGEN_ALL_READ;
}

/** Currents of the first and the second phase: measured, or the rest of the other two. */
static inline void hexagen_sense(const hexagen_supervisor *supervisor, const hexagen_limits *limits,
    uint16_t count_a, uint16_t count_b, uint16_t count_c, int32_t *first, int32_t *second)
{
    const uint16_t unread = hexagen_unread(supervisor, limits);
    const int32_t a = hexagen_current(limits, 0, count_a, supervisor->offset[0]);
    const int32_t b = hexagen_current(limits, 1, count_b, supervisor->offset[1]);
    const int32_t c = hexagen_current(limits, 2, count_c, supervisor->offset[2]);
    *first = (unread == 0U) ? hexagen_third(b, c) : a;
    *second = (unread == 1U) ? hexagen_third(a, c) : b;
}

/** Whether the ADC of a leg that is read is at an end of its range. */
static inline bool hexagen_has_end(const hexagen_supervisor *supervisor,
    const hexagen_limits *limits, const hexagen_sample *sample)
{
    const uint16_t unread = hexagen_unread(supervisor, limits);
    return (unread != 0U && hexagen_is_at_end(limits, hexagen_count(limits, sample, 0)))
        || (unread != 1U && hexagen_is_at_end(limits, hexagen_count(limits, sample, 1)))
        || (unread != 2U && hexagen_is_at_end(limits, hexagen_count(limits, sample, 2)));
}

/** Whether as many samples as trip had three currents that do not add up to nothing. */
static inline bool hexagen_is_sum_off(
    const hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    return limits->third.sum_samples != 0U && supervisor->sum_count == limits->third.sum_samples;
}

/** A sensor's phase current, of a count within the ADC's range. */
static inline int32_t hexagen_measured(const hexagen_supervisor *supervisor,
    const hexagen_limits *limits, const hexagen_sample *sample, uint16_t sensor)
{
    const uint16_t count = hexagen_count_within(limits, sample, sensor);
    return hexagen_current(limits, sensor, count, supervisor->offset[sensor]);
}

/** Counts such samples; true for as many as trip. */
static inline bool hexagen_watch_sum(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample)
{
    const uint16_t most = limits->third.sum_samples;
    if (!limits->third.is_there) {
        return false;
    }
    if (supervisor->mode != HEXAGEN_MODE_RUN || most == 0U) {
        supervisor->sum_count = 0;
    } else if (hexagen_unread(supervisor, limits) == HEXAGEN_ALL_READ) {
        const uint32_t sum = (uint32_t)hexagen_measured(supervisor, limits, sample, 0)
            + (uint32_t)hexagen_measured(supervisor, limits, sample, 1)
            + (uint32_t)hexagen_measured(supervisor, limits, sample, 2);
        if (!hexagen_exceeds(hexagen_wrap(sum), limits->third.sum_tolerance)) {
            supervisor->sum_count = 0;
        } else if (supervisor->sum_count < most) {
            supervisor->sum_count = (uint16_t)(supervisor->sum_count + 1U);
        } else {
            supervisor->sum_count = most;
        }
    }
    return hexagen_is_sum_off(supervisor, limits);
}

/** Whether a leg is low for long enough to be read at the end of its period. */
static inline bool hexagen_is_read(
    const hexagen_limits *limits, const hexagen_legs *legs, uint16_t leg)
{
    return legs->state[leg] == HEXAGEN_LEG_LOW
        || (legs->state[leg] == HEXAGEN_LEG_PULSED && legs->compare[leg] <= limits->third.readable);
}

/**
 * Remembers which leg the command of a controlled period leaves unread at its end, with three sensors
 * in the low legs. hexagen_rest does this for the periods that it handles.
 */
static inline void hexagen_follow_legs(
    hexagen_supervisor *supervisor, const hexagen_limits *limits, const hexagen_legs *legs)
{
    uint32_t leg;
    if (!limits->third.is_low_side) {
        return;
    }
    leg = !hexagen_is_read(limits, legs, 0) ? 0U
        : !hexagen_is_read(limits, legs, 1) ? 1U
        : !hexagen_is_read(limits, legs, 2) ? 2U
                                            : HEXAGEN_ALL_READ;
    supervisor->unread = limits->third.is_delayed
        ? (uint16_t)(((uint32_t)supervisor->unread >> 2) | (leg << 2))
        : (uint16_t)leg;
}

/** Whether a phase current is above the trip level: one that is sensed, or the third. */
static inline bool hexagen_is_over(const hexagen_limits *limits, int32_t first, int32_t second)
{
    const int32_t third = hexagen_third(first, second);
    return hexagen_exceeds(first, limits->trip) || hexagen_exceeds(second, limits->trip)
        || hexagen_exceeds(third, limits->trip);
}

/** Whether a Hall code is not disturbed. Codes of sectors side by side differ in one sensor. */
static inline bool hexagen_is_sound(
    const hexagen_supervisor *supervisor, const hexagen_limits *limits, uint16_t hall)
{
    const uint32_t changed = (uint32_t)hall ^ supervisor->hall_prev;
    const bool is_beside = (changed & (changed - 1U)) == 0U;
    return hexagen_is_hall_code(hall)
        && (limits->hall_glitches == 0U || supervisor->hall_prev == 0U || is_beside);
}

/**
 * Follows the Hall code of a sample, which is disturbed or not; whether it is another one than the
 * last, which without stall detection and bridging is not known.
 */
static inline bool hexagen_watch_hall(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    uint16_t hall, bool is_sound)
{
    const uint16_t before = supervisor->hall_prev;
    if (is_sound && (limits->stall_periods != 0 || limits->hall_glitches != 0U)) {
        supervisor->hall_prev = hall;
        supervisor->hall_gap = 0;
    }
    return is_sound && hall != before && before != 0U;
}

/** Whether the stall time-out has passed. */
static inline bool hexagen_is_stalled(
    const hexagen_supervisor *supervisor, const hexagen_limits *limits)
{
    return limits->stall_periods != 0 && supervisor->stall_count == limits->stall_periods;
}

/** Counts periods without a Hall edge under demand; true on a stall. */
static inline bool hexagen_watch_stall(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    bool is_edge, const volatile int32_t *set_point)
{
    if (limits->stall_periods != 0) {
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
 * Whether the period is fit for control, with the checked sample. False if the drive is starting
 * up, off on purpose or tripped, or the sample has a fault; then call hexagen_examine with the same
 * sample. `set_point` is 0 if no current is demanded.
 */
static inline bool hexagen_check(hexagen_supervisor *supervisor, const hexagen_limits *limits,
    const hexagen_sample *sample, const volatile int32_t *set_point, hexagen_checked *checked)
{
    const uint16_t hall = hexagen_hall_of(limits, sample);
    const bool is_sound = hexagen_is_sound(supervisor, limits, hall);
    const bool is_edge = hexagen_watch_hall(supervisor, limits, hall, is_sound);
    const bool is_stalled = hexagen_watch_stall(supervisor, limits, is_edge, set_point);
    const bool is_sum_off = hexagen_watch_sum(supervisor, limits, sample);
    int32_t first;
    int32_t second;
    hexagen_sense(supervisor, limits, hexagen_count(limits, sample, 0),
        hexagen_count(limits, sample, 1), hexagen_count(limits, sample, 2), &first, &second);
    hexagen_take_currents(limits, checked, first, second, hexagen_third(first, second));
    checked->hall = (int32_t)hall;
    checked->hall_ticks = (int32_t)sample->hall_ticks;
    checked->angle = hexagen_wrap(sample->angle);
    return supervisor->mode == HEXAGEN_MODE_RUN && !hexagen_has_end(supervisor, limits, sample)
        && is_sound && !hexagen_is_over(limits, first, second) && !is_sum_off && !is_stalled;
}

/**
 * A supervisor that starts, with nominal offsets: control follows, once the rotor's angle is known.
 */
void hexagen_start(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/** What a drive does in a period that is not fit for control. */
typedef struct {
    /** The period is one of control after all: a disturbed Hall code is bridged, or it brakes. */
    bool is_controlled;
    /** It brakes a fast rotor: control with the largest torque against its direction. */
    bool is_braking;
    /** 1 forward, -1 backward; 0 while it is unknown: control at set-point 0. */
    int32_t against;
    /** It rests for this fault, the first that was found; or without one. */
    hexagen_fault fault;
} hexagen_unfit;

/**
 * What the drive does in a period that is not fit for control: hexagen_check returned false, or a
 * fault is `known` already, which no sample shows. Bridges a disturbed Hall code, brakes, or says that
 * it rests; then call hexagen_rest. In the checked sample, counts are clamped to the ADC's range, the
 * current of a phase that is not read to that of one that is; a Hall code that is bridged is the last
 * one, and another that no sensors give is 0.
 */
HEXAGEN_COLD hexagen_unfit hexagen_examine(hexagen_supervisor *supervisor,
    const hexagen_limits *limits, const hexagen_sample *sample, hexagen_fault known,
    hexagen_checked *checked);

/**
 * A period without control, which hexagen_examine found to be one: trips on the fault, or continues
 * start-up; the state of all legs. It is apart, so that no way leads from a trip or a start-up to
 * control, and the longest computation time is that of one of them.
 */
HEXAGEN_COLD hexagen_leg hexagen_rest(hexagen_supervisor *supervisor,
    const hexagen_limits *limits, const hexagen_sample *sample, hexagen_fault fault);

/**
 * Keeps the supervisor in the record of a trip. Word by word: a library copies a block of any length
 * and alignment, whose longest path is several times as long.
 */
HEXAGEN_COLD void hexagen_keep(
    volatile hexagen_supervisor *kept, const hexagen_supervisor *supervisor);

/**
 * Clears a trip; keeps calibrated offsets. False, without effect, during calibration and
 * pre-charge.
 */
bool hexagen_reset(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/**
 * Starts calibration; ignored when tripped. No current is judged meanwhile: without offsets a count
 * tells none, and a trip would turn off what is off already.
 */
void hexagen_calibrate(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/**
 * Starts pre-charge; ignored when tripped, calibrating, coasting and braking, and if the
 * specification has none.
 */
void hexagen_precharge(hexagen_supervisor *supervisor, const hexagen_limits *limits);

/** Turns all legs off until hexagen_resume. Ignored when tripped, calibrating and pre-charging. */
void hexagen_coast(hexagen_supervisor *supervisor);

/**
 * Brakes until hexagen_resume: all lower switches on where the short-circuited motor takes no more
 * than the largest current, above that speed this current against the rotation; none until two
 * Hall edges in one direction tell it. A rotor that stands stays shorted whatever one sensor does.
 * Ignored when tripped, calibrating and pre-charging.
 */
void hexagen_brake(hexagen_supervisor *supervisor);

/**
 * Ends coasting and braking: what is left of a start follows, or control. False, without effect, if
 * the drive does neither.
 */
bool hexagen_resume(hexagen_supervisor *supervisor);

/** Count of bridged samples at which counting ends. */
#define HEXAGEN_MOST_GLITCHES 0x7fffU

/** Mode, fault and bridged samples in one word, as the control loop publishes them. */
static inline int32_t hexagen_status_word(const hexagen_supervisor *supervisor)
{
    return (int32_t)supervisor->mode | ((int32_t)supervisor->fault << 8)
        | ((int32_t)supervisor->hall_glitches * INT32_C(0x10000));
}

/* ---- Bus voltage ------------------------------------------------------------------------- */

/**
 * A measured bus voltage as two words that are replaced together, while other contexts of the same
 * core may read: two banks, one of them published. A reader that interrupts a call gets both old
 * words.
 */
typedef struct {
    volatile int32_t banks[2][2];
    /** The published bank. */
    volatile int32_t published;
    /** Control periods left of a call in progress; 0 for none. */
    volatile int32_t storing;
    /**
     * Not 0: a call took effect since the last control period, with a sound voltage, HEXAGEN_SOUND,
     * or one with the fault of this number.
     */
    volatile int32_t told;
    /** Control periods until the voltage is stale; written by the control loop only. */
    volatile int32_t left;
} hexagen_bus;

/** Control periods after which an unfinished call is given up. */
#define HEXAGEN_GIVEN_UP INT32_C(65536)

/** Initial state, with the words of the nominal voltage. */
void hexagen_start_bus(hexagen_bus *bus, int32_t first, int32_t second);

/** A call of `set_bus` whose voltage has no fault. */
#define HEXAGEN_SOUND (-INT32_C(1))

/** What is wrong with a bus voltage of so many ADC counts; HEXAGEN_SOUND if nothing. */
static inline int32_t hexagen_judge_bus(const hexagen_limits *limits, uint16_t counts)
{
    return (counts > limits->bus_most) ? (int32_t)HEXAGEN_FAULT_OVER_VOLTAGE
        : (counts < limits->bus_least) ? (int32_t)HEXAGEN_FAULT_UNDER_VOLTAGE
                                       : HEXAGEN_SOUND;
}

/**
 * Replaces both words together, by those of a voltage of which hexagen_judge_bus said this. A call
 * that interrupts another one has no effect; one that never resumes after an interruption blocks
 * later calls for HEXAGEN_GIVEN_UP control periods.
 */
void hexagen_tell_bus(hexagen_bus *bus, int32_t first, int32_t second, int32_t judged);

/** The words of the last call. */
static inline const volatile int32_t *hexagen_bus_words(const hexagen_bus *bus)
{
    return bus->banks[(bus->published == 0) ? 0 : 1];
}

/**
 * Called at each control period: ages the voltage, and a call in progress. The voltage is stale
 * after `periods` of them without a call that takes effect. Returns the fault of the voltage that was
 * told since the last period, if it has one.
 */
static inline hexagen_fault hexagen_pass_period(hexagen_bus *bus, int32_t periods)
{
    const int32_t storing = bus->storing;
    const int32_t told = bus->told;
    if (storing != 0) {
        bus->storing = storing - 1;
    }
    if (told != 0) {
        bus->told = 0;
        bus->left = periods;
    } else {
        const int32_t left = bus->left;
        if (left != 0) {
            bus->left = left - 1;
        }
    }
    return (told > 0) ? (hexagen_fault)told : HEXAGEN_FAULT_NONE;
}

/** Whether the voltage is stale, as of the last control period. */
static inline bool hexagen_bus_is_stale(const hexagen_bus *bus)
{
    return bus->left == 0;
}

/* ---- Signals ------------------------------------------------------------------------------ */

/** Marks a word without a value. */
#define HEXAGEN_NONE INT32_MIN

/** Estimates of a law, in its own words; HEXAGEN_NONE for those it does not make. */
typedef struct {
    /** EMF of phases a and b, words of voltage. */
    int32_t e_a;
    int32_t e_b;
    /** Speed, forward positive; 0 while it is unknown. */
    int32_t speed;
} hexagen_observation;

/** The observation of a law without estimates. */
#define HEXAGEN_UNOBSERVED { HEXAGEN_NONE, HEXAGEN_NONE, HEXAGEN_NONE }

/*
 * If HEXAGEN_SIGNALS is defined, in all files of a program alike. The test for a request takes some
 * ten instructions of every control period, and a drive 40 bytes more.
 */
#ifdef HEXAGEN_SIGNALS

/**
 * Measurements, estimates and command of one control period: numbers with 16 fraction bits, which
 * saturate at +-32768.
 */
typedef struct {
    /** Currents of phases a, b, c into the motor at the begin of the period, ampere. */
    int32_t currents[3];
    /**
     * Mean terminal voltages of the command (with `delay: 1` in effect in the next period), volt
     * against the negative rail at the nominal bus; 0 for a leg that is off.
     */
    int32_t voltages[3];
    /** Whether the legs are off. */
    bool is_off[3];
    /**
     * Whether the law estimates the EMF, and that of phases a, b, c in the period in which the
     * command takes effect (PHCC: in the current one), volt; else 0.
     */
    bool has_emf;
    int32_t emf[3];
    /** Whether the law measures the speed, and the speed in rpm, forward positive; 0 if unknown. */
    bool has_speed;
    int32_t speed;
    /** Sector 1 to 6. */
    uint16_t sector;
} hexagen_signals;

/** Unit of a word: a factor with 16 fraction bits, times 2^shift; shift is 1 to 62. */
typedef struct {
    int32_t factor;
    uint16_t shift;
} hexagen_unit;

/** Units of a drive's signals. */
typedef struct {
    /** Ampere per word of current. */
    hexagen_unit ampere;
    /** Volt per word of voltage. */
    hexagen_unit volt;
    /** Volt per timer count at the nominal bus. */
    hexagen_unit volt_per_count;
    /** Revolutions per minute per word of speed. */
    hexagen_unit rpm;
    /** Sector 1 to 6 by Hall code; 0 for invalid codes. */
    uint16_t sectors[8];
} hexagen_units;

/**
 * Hands the words of a period from the control loop to the main program. The control loop writes
 * only while they are requested; the main program writes only while they are not, and reads only
 * after the answer. Neither side waits for the other.
 */
typedef struct {
    /**
     * 0: idle. 1: words of the next controlled period are requested. 2: answered. 3: the main
     * program is reading.
     */
    volatile int32_t turn;
    volatile int32_t words[9];
} hexagen_port;

/** A port without a request. */
void hexagen_start_port(hexagen_port *port);

/** Whether the words of this period are requested. */
static inline bool hexagen_is_asked(const hexagen_port *port)
{
    return port->turn == 1;
}

/** Legs whose upper switches are on for as long; one that is off throughout is off. */
HEXAGEN_COLD hexagen_legs hexagen_legs_of(hexagen_intervals intervals);

/** Answers with the words of this period; by value, so that they use memory on this path only. */
HEXAGEN_COLD void hexagen_answer(hexagen_port *port, hexagen_checked checked, hexagen_legs legs,
    hexagen_observation observation);

/** The signals, if answered; else requests those of the next controlled period. */
bool hexagen_take(hexagen_port *port, const hexagen_units *units, hexagen_signals *signals);

#endif

/* ---- Verification ------------------------------------------------------------------------ */

#ifdef HEXAGEN_VERIFICATION
/** Words of a supervisor. */
#define HEXAGEN_WORDS 19

/**
 * Copies the words of a supervisor: mode, fault, countdown, sum_a, sum_b, offset_a, offset_b,
 * stall_count, hall_prev, hall_gap, hall_glitches, turn_hall, turn_age, turn_interval,
 * turn_direction, sum_c, offset_c, sum_count, unread.
 */
void hexagen_words(const hexagen_supervisor *supervisor, int32_t *words);

/** Overwrites them with values inside their ranges. */
void hexagen_set_words(hexagen_supervisor *supervisor, const int32_t *words);
#endif

#ifdef __cplusplus
}
#endif

#endif
