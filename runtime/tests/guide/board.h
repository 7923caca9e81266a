/** What the guide's programs in C need of a board. */
#include "hexagen.h"

uint16_t adc_a(void);
uint16_t adc_b(void);
uint16_t hall_code(void);
uint16_t hall_ticks(void);
uint16_t bus_count(void);
void set_compare(uint16_t leg, uint16_t counts);
void enable_upper(uint16_t leg, bool is_enabled);
void enable_lower(uint16_t leg, bool is_enabled);
void tell(hexagen_fault fault);

/* The program. */
void start(void);
void control_interrupt(void);
void ask(int32_t milliamperes);
void go_on(void);
