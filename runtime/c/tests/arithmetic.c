/* Compares the arithmetic of the runtime with 128-bit arithmetic, for words at the ends of their
 * range, small ones, and random ones. */
#include "hexagen.h"

#include <stdio.h>

__extension__ typedef __int128 wide;

static const wide TURN = (wide)1 << 32;

static uint64_t seed = 1;

static uint32_t bits(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(seed >> 32);
}

static wide power(unsigned n)
{
    return (wide)1 << n;
}

/* Quotient, rounded down. */
static wide over(wide x, wide y)
{
    return x / y - ((x % y < 0) ? 1 : 0);
}

static wide least(wide x, wide y)
{
    return (x < y) ? x : y;
}

static wide greatest(wide x, wide y)
{
    return (x > y) ? x : y;
}

static wide size(wide x)
{
    return (x < 0) ? -x : x;
}

static int fits(wide x)
{
    return x >= INT32_MIN && x <= INT32_MAX;
}

/* The word with these bits. */
static wide word_of(wide x)
{
    const wide below = x - over(x, TURN) * TURN;
    return (below >= TURN / 2) ? below - TURN : below;
}

/* An end of the range or a neighbour of one, or a number of random length. */
static int32_t any(void)
{
    static const int32_t ends[] = { INT32_MIN, INT32_MIN + 1, -65536, -65535, -2, -1, 0, 1, 2, 3,
        32767, 32768, 65535, 65536, 0x3fffffff, 0x40000000, INT32_MAX - 1, INT32_MAX };
    const uint32_t choice = bits();
    if (choice % 4U == 0U) {
        return ends[(choice >> 8) % (sizeof ends / sizeof ends[0])];
    }
    return (int32_t)over(word_of(bits()), power((choice >> 8) % 32U));
}

static int32_t natural(void)
{
    const int32_t word = any();
    return (word < 0) ? -(word + 1) : word;
}

/** One of the displacements. */
static int32_t hexagen_hall_offset(int32_t first, int32_t second, int32_t all, size_t sensor)
{
    int32_t degrees[3];
    hexagen_hall_offsets(first, second, all, degrees);
    return degrees[sensor];
}

/* Compares a primitive with its expected value. */
#define EXPECT(primitive, expected)                                                          \
    do {                                                                                     \
        const wide is = (hexagen_##primitive), should = (expected);                          \
        if (is != should) {                                                                  \
            printf("%s with x %ld, y %ld, z %ld, w %ld, shift %u is %ld, not %ld\n",          \
                #primitive, (long)x, (long)y, (long)z, (long)w, (unsigned)shift, (long)is,   \
                (long)should);                                                               \
            return 1;                                                                        \
        }                                                                                    \
    } while (0)

int main(void)
{
    unsigned long round;
    for (round = 0; round < 400000UL; round++) {
        int32_t x = any(), y = any(), z = any(), w = any();
        const wide product = (wide)x * y, sum = (wide)x + y, both = product + (wide)z * w;
        uint16_t shift = (uint16_t)(bits() % 31U);
        EXPECT(wrap((uint32_t)x), x);
        EXPECT(angle_add(x, y), word_of(sum));
        EXPECT(angle_sub(x, y), word_of((wide)x - y));
        if (x != INT32_MIN) {
            EXPECT(abs(x), size(x));
        }
        EXPECT(min(x, y), least(x, y));
        EXPECT(max(x, y), greatest(x, y));
        EXPECT(clamp(x, (int32_t)least(y, z), (int32_t)greatest(y, z)),
            least(greatest(x, least(y, z)), greatest(y, z)));
        EXPECT(shift_right(x, shift), over(x, power(shift)));
        if (fits(x * power(shift))) {
            EXPECT(shift_left(x, shift), x * power(shift));
        }
        if (shift > 0U && fits(product) && fits(product + power(shift - 1U))) {
            EXPECT(mul_round_narrow(x, y, shift),
                over(product + power(shift - 1U), power(shift)));
        }
        EXPECT(upper_by_halves(x, y), over(product, TURN));
        EXPECT(product(x, y), product);
        shift = (uint16_t)(1U + bits() % 62U);
        if (fits(over(product, power(shift)))) {
            EXPECT(mul_floor(x, y, shift), over(product, power(shift)));
            EXPECT(shift_right_wide((int64_t)x * y, shift), over(product, power(shift)));
        }
        if (fits(over(product + power(shift - 1U), power(shift)))) {
            EXPECT(mul_round(x, y, shift), over(product + power(shift - 1U), power(shift)));
        }
        if (both < power(63) && both >= -power(63) && fits(over(both, power(shift)))) {
            EXPECT(mul_add_floor(x, y, z, w, shift), over(both, power(shift)));
        }
        shift = (uint16_t)(1U + bits() % 30U);
        EXPECT(remainder(x, shift), x - over(x, power(shift)) * power(shift));
        {
            /* Any limit, or one next to a magnitude. */
            const int32_t near = (int32_t)(bits() % 3U) - 1;
            const wide about = greatest(0, least(size(x) + near, INT32_MAX));
            const wide limit = (bits() % 2U == 0U) ? natural() : about;
            EXPECT(exceeds(x, (int32_t)limit), size(x) > limit);
        }
        x = natural();
        y = natural();
        z = natural();
        EXPECT(mul_limited(x, y, z), least((wide)x * y, z));
        if (y >= 2) {
            EXPECT(turn_over(y), (TURN - 1) / y);
        }
        y = (int32_t)greatest(y, 1);
        /* Half of the numerators just below a multiple of the denominator, where digits are
         * corrected. */
        shift = (uint16_t)(bits() % 32U);
        if (bits() % 2U == 0U) {
            x = (int32_t)least(
                greatest((wide)y * (bits() % 3U + 1U) - 1 - bits() % 16U, 0), INT32_MAX);
        }
        if (bits() % 2U == 0U) {
            z = INT32_MAX;
        }
        EXPECT(divide(x, y, z, shift), least(x * power(shift) / y, z));
        if (x * power(shift) < TURN) {
            EXPECT(divide_narrow(x, y, z, shift), least(x * power(shift) / y, z));
        }
        {
            const wide limited = least(greatest(w, -32767999), 32767999);
            const wide made = hexagen_thousandths(w);
            /* To the nearest, within the precision of a 32-bit coefficient. */
            EXPECT(thousandths(w), (size(made * 1000 - limited * 65536) <= 508) ? made : made + 1);
        }
        {
            const int32_t first = w / 24, second = x / 24, all = y / 24;
            const wide own[3] = {first, second, -(wide)first - second};
            const size_t sensor = bits() % 3U;
            const wide lowest = least(least(own[0], own[1]), own[2]);
            const wide highest = greatest(greatest(own[0], own[1]), own[2]);
            const wide middle = own[0] + own[1] + own[2] - lowest - highest;
            EXPECT(hall_offset(first, second, all, sensor),
                over(360 * (own[sensor] - middle + all) + power(15), power(16)));
        }
        EXPECT(whole(w), least(greatest(w * power(16), INT32_MIN), INT32_MAX));
        {
            const uint32_t segments = 1U + bits() % 65536U;
            const wide turns = (wide)(uint32_t)w * segments;
            EXPECT(angle_index(w, segments), turns / TURN);
            EXPECT(angle_index_by_halves(w, segments), turns / TURN);
            EXPECT(angle_fraction(w, segments), turns % TURN - TURN / 2);
        }
    }
    printf("no difference\n");
    return 0;
}
