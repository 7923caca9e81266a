/* Start-up of a drive with 16 samples of calibration and 4 periods of pre-charge, as firmware calls it. */
#include "hub.h"
#include <stdio.h>

static hub_t drive;

#define EXPECT(what)                                    \
    do {                                                \
        if (!(what)) {                                  \
            printf("line %d: %s\n", __LINE__, #what);   \
            return 1;                                   \
        }                                               \
    } while (0)

/* Steps whose legs are all in a state; how many of them come before the first that is not. */
static int steps(int count, hub_mode_t mode, hub_leg_t leg, uint16_t adc_a, uint16_t adc_b)
{
    int done;
    for (done = 0; done < count; done++) {
        const hub_mode_t before = hub_status(&drive).mode;
        const hub_legs_t legs = hub_step(&drive, adc_a, adc_b, 5);
        if (before != mode || legs.state[0] != leg || legs.state[1] != leg || legs.state[2] != leg) {
            break;
        }
    }
    return done;
}

/* Whether these counts are the offsets; `unit` is what one count is. */
static int32_t unit;

static int has_offsets(int32_t adc_a, int32_t adc_b)
{
    return drive.state.offset_a == adc_a * unit && drive.state.offset_b == adc_b * unit;
}

/* A whole start-up with these offsets: the samples of pre-charge and control are others. */
static int starts_up(uint16_t adc_a, uint16_t adc_b)
{
    return steps(16, HUB_MODE_CALIBRATE, HUB_LEG_OFF, adc_a, adc_b) == 16 && has_offsets(adc_a, adc_b)
        && steps(4, HUB_MODE_PRECHARGE, HUB_LEG_LOW, 2030, 2060) == 4 && has_offsets(adc_a, adc_b)
        && steps(40, HUB_MODE_RUN, HUB_LEG_PULSED, 2040, 2050) == 40 && has_offsets(adc_a, adc_b);
}

int main(void)
{
    hub_init(&drive);
    unit = drive.state.offset_a / 2048;
    EXPECT(has_offsets(2048, 2048));
    EXPECT(hub_is_running(&drive));
    hub_calibrate(&drive);
    EXPECT(hub_status(&drive).mode == HUB_MODE_CALIBRATE);
    EXPECT(!hub_is_running(&drive));
    EXPECT(starts_up(2148, 1998));

    /* Again, from control. */
    hub_calibrate(&drive);
    EXPECT(starts_up(1948, 2098));

    /* Again, halfway: nothing of the first half counts. */
    hub_calibrate(&drive);
    EXPECT(steps(8, HUB_MODE_CALIBRATE, HUB_LEG_OFF, 2148, 1948) == 8);
    hub_calibrate(&drive);
    EXPECT(starts_up(2068, 2008));

    /* Again, in pre-charge. */
    hub_calibrate(&drive);
    EXPECT(steps(16, HUB_MODE_CALIBRATE, HUB_LEG_OFF, 2148, 1948) == 16);
    EXPECT(steps(2, HUB_MODE_PRECHARGE, HUB_LEG_LOW, 2148, 1948) == 2);
    hub_calibrate(&drive);
    EXPECT(hub_status(&drive).mode == HUB_MODE_CALIBRATE);
    EXPECT(starts_up(2048, 2028));

    /* A trip, which only reset ends; offsets are kept. */
    (void)hub_step(&drive, 2048, 2028, 0);
    EXPECT(hub_status(&drive).mode == HUB_MODE_TRIPPED && hub_fault(&drive) == HUB_FAULT_HALL);
    hub_calibrate(&drive);
    hub_precharge(&drive);
    EXPECT(hub_status(&drive).mode == HUB_MODE_TRIPPED);
    hub_reset(&drive);
    EXPECT(hub_is_running(&drive) && hub_fault(&drive) == HUB_FAULT_NONE);
    EXPECT(steps(40, HUB_MODE_RUN, HUB_LEG_PULSED, 2048, 2028) == 40 && has_offsets(2048, 2028));
    hub_precharge(&drive);
    EXPECT(hub_status(&drive).mode == HUB_MODE_PRECHARGE);
    EXPECT(steps(4, HUB_MODE_PRECHARGE, HUB_LEG_LOW, 2048, 2028) == 4);
    EXPECT(hub_is_running(&drive));
    printf("as it should be\n");
    return 0;
}
