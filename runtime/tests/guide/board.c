/* A board whose rotor stands in sector 2 and draws no current; its first ADC then goes to an end. */
#include "board.h"
#include <stdio.h>

static uint16_t count_a = 2048;
static bool is_upper_enabled[3];
static hexagen_fault told = HEXAGEN_FAULT_NONE;

uint16_t adc_a(void) { return count_a; }
uint16_t adc_b(void) { return 2048; }
uint16_t hall_code(void) { return 5; }
uint16_t hall_ticks(void) { return 65535; }
/* 36 V of 109 V. */
uint16_t bus_count(void) { return 1353; }
void set_compare(uint16_t leg, uint16_t counts) { (void)leg, (void)counts; }
void enable_upper(uint16_t leg, bool is_enabled) { is_upper_enabled[leg] = is_enabled; }
void enable_lower(uint16_t leg, bool is_enabled) { (void)leg, (void)is_enabled; }
void tell(hexagen_fault fault) { told = fault; }

static void pass(uint16_t periods)
{
    for (; periods > 0; periods--) {
        control_interrupt();
    }
}

int main(void)
{
    start();
    ask(0);
    /* Calibration, pre-charge and the start take 1,100 periods. */
    pass(2000);
    ask(1000);
    pass(1);
    if (is_upper_enabled[0] && told == HEXAGEN_FAULT_NONE) {
        printf("runs");
    }
    count_a = 4095;
    pass(1);
    ask(1000);
    if (!is_upper_enabled[0] && told == HEXAGEN_FAULT_ADC_RANGE) {
        printf(", trips");
    }
    count_a = 2048;
    told = HEXAGEN_FAULT_NONE;
    go_on();
    pass(2000);
    ask(0);
    if (is_upper_enabled[0] && told == HEXAGEN_FAULT_NONE) {
        printf(", starts\n");
    }
    return 0;
}
