/* Runs an emitted drive on calls from stdin; `link.rs` of the `hexagen` program is the other end.
 *
 * `binding.h` names the drive: `drive_type`, `CALL(function)`, STATE_WORDS, and what it has. */
#include "binding.h"
#include <stdio.h>
#include <stdlib.h>

static const unsigned char *batch;

static uint32_t bytes(int count)
{
    uint32_t number = 0;
    for (int at = 0; at < count; at++) {
        number |= (uint32_t)batch[at] << (8 * at);
    }
    batch += count;
    return number;
}

static int32_t word(void)
{
    return hexagen_wrap(bytes(4));
}

static void answer(int count, uint32_t number)
{
    for (int at = 0; at < count; at++) {
        if (putchar((int)((number >> (8 * at)) & 255U)) == EOF) {
            exit(2);
        }
    }
}

#if HAS_INTERVALS
typedef hexagen_intervals command_type;

static void answer_command(const hexagen_intervals *intervals)
{
    answer(2, intervals->end[0]);
    answer(2, intervals->end[1]);
    for (int interval = 0; interval < 3; interval++) {
        if (intervals->states[interval] > 63U) {
            exit(3);
        }
        answer(1, intervals->states[interval]);
    }
    answer(1, 0U);
}
#else
typedef hexagen_legs command_type;

static void answer_command(const hexagen_legs *legs)
{
    uint32_t states = 0;
    for (int leg = 0; leg < 3; leg++) {
        answer(2, legs->compare[leg]);
        states |= (uint32_t)legs->state[leg] << (2 * leg);
    }
    answer(2, states);
}
#endif

static void step(drive_type *drive)
{
    const uint16_t adc_a = (uint16_t)bytes(2);
    const uint16_t adc_b = (uint16_t)bytes(2);
    const uint16_t adc_c = (uint16_t)bytes(2);
    const uint16_t hall = (uint16_t)bytes(1);
    const uint16_t hall_ticks = (uint16_t)bytes(2);
    const uint32_t angle = bytes(4);
    /* A sample has either; the other is 0. */
    const hexagen_sample rotor = angle == 0U
        ? hexagen_with_ticks(hexagen_with_hall(adc_a, adc_b, hall), hall_ticks)
        : hexagen_with_angle(adc_a, adc_b, angle);
    const hexagen_sample sample = hexagen_with_third(rotor, adc_c);
    const command_type command = CALL(step)(drive, &sample);
    const hexagen_status status = CALL(status)(drive);
    answer_command(&command);
    answer(1, (uint32_t)status.fault);
    answer(1, status.bus_is_stale ? 1U : 0U);
    int32_t words[STATE_WORDS];
    CALL(state_words)(drive, words);
    for (int at = 0; at < STATE_WORDS; at++) {
        answer(4, (uint32_t)words[at]);
    }
}

static void set_bus(drive_type *drive, uint16_t counts)
{
#if HAS_BUS
    CALL(set_bus)(drive, counts);
#else
    (void)drive;
    (void)counts;
#endif
}

static void set_speed(drive_type *drive, int32_t speed)
{
#if HAS_SPEED
    CALL(set_speed)(drive, speed);
#else
    (void)drive;
    (void)speed;
#endif
}

static void set_state_words(drive_type *drive)
{
    int32_t words[STATE_WORDS];
    for (int at = 0; at < STATE_WORDS; at++) {
        words[at] = word();
    }
    CALL(set_state_words)(drive, words);
}

static void serve(drive_type *drive)
{
    switch (bytes(1)) {
    case 0:
        CALL(init)(drive);
        break;
    case 1:
        step(drive);
        break;
    case 2:
        CALL(set_current)(drive, word());
        break;
    case 3:
        CALL(set_torque)(drive, word());
        break;
    case 4:
        set_bus(drive, (uint16_t)bytes(2));
        break;
    case 5:
        CALL(reset)(drive);
        break;
    case 6:
        CALL(calibrate)(drive);
        break;
    case 7:
        CALL(precharge)(drive);
        break;
    case 9:
        set_speed(drive, word());
        break;
    case 10:
        CALL(coast)(drive);
        break;
    case 11:
        CALL(brake)(drive);
        break;
    case 12:
        CALL(resume)(drive);
        break;
    default:
        set_state_words(drive);
        break;
    }
}

int main(void)
{
    static drive_type drive;
    unsigned char length[4];
    CALL(init)(&drive);
    while (fread(length, 1, sizeof length, stdin) == sizeof length) {
        batch = length;
        const size_t size = bytes(4);
        unsigned char *const calls = malloc(size + 1);
        if (calls == NULL || fread(calls, 1, size, stdin) != size) {
            return 1;
        }
        batch = calls;
        while (batch < calls + size) {
            serve(&drive);
        }
        free(calls);
        if (fflush(stdout) != 0) {
            return 2;
        }
    }
    return 0;
}
