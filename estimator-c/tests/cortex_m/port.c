/* Start, stack and output of the example on Arm's AN386 in QEMU. No C library is linked. */

#include "port.h"
#include <stddef.h>

extern uint32_t stack_top[];
extern uint32_t stack_bottom[];
/* A little below the top, which is in use where the stack is painted. */
extern uint32_t stack_unused[];
extern uint32_t bss_start[];
extern uint32_t bss_end[];
int main(void);

static const uint32_t PAINT = 0xA5A5A5A5u;

__asm__(".section .rodata\n"
        ".balign 4\n.global port_table\nport_table:\n.incbin \"" TABLE "\"\n"
        ".global port_table_end\nport_table_end:\n.previous\n");

static uint32_t semihosting(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void quit(int failed) {
    /* SYS_EXIT with ADP_Stopped_ApplicationExit, or with a run-time error. */
    semihosting(0x18, (const void *)(failed ? 0x20023u : 0x20026u));
    for (;;) {
    }
}

void port_print(const char *text) {
    semihosting(0x04, text);
    semihosting(0x04, "\n");
}

static char *hexadecimal(char *end, uint32_t number) {
    for (int digit = 7; digit >= 0; digit--) {
        *end++ = "0123456789abcdef"[(number >> (4 * digit)) & 15u];
    }
    *end++ = ' ';
    return end;
}

static uint32_t bits(float number) {
    union {
        float number;
        uint32_t bits;
    } both = {number};
    return both.bits;
}

void port_print_bits(char letter, float first, float second, uint32_t third, uint32_t fourth) {
    char line[2 + 4 * 9];
    line[0] = letter;
    line[1] = ' ';
    char *end = hexadecimal(hexadecimal(hexadecimal(hexadecimal(line + 2, bits(first)), bits(second)), third), fourth);
    end[-1] = '\0';
    port_print(line);
}

void port_print_stack(void) {
    const uint32_t *used = stack_bottom;
    while (*used == PAINT) {
        used++;
    }
    port_print_bits('S', 0.0f, 0.0f, 0, (uint32_t)((const char *)stack_top - (const char *)used));
}

static void start(void) {
    /* CPACR: the floating-point unit, for all. */
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm__ volatile("dsb\nisb");
    for (volatile uint32_t *word = bss_start; word < bss_end; word++) {
        *word = 0;
    }
    for (volatile uint32_t *word = stack_bottom; word < stack_unused; word++) {
        *word = PAINT;
    }
    quit(main());
}

static void fault(void) {
    port_print("fault");
    quit(1);
}

/* What the processor reads where it starts: the stack pointer, then where to go at reset and at six kinds of fault. */
typedef struct {
    uint32_t *stack;
    void (*handlers[7])(void);
} Vectors;

__attribute__((section(".vectors"), used)) static const Vectors vectors = {
    stack_top,
    {start, fault, fault, fault, fault, fault, fault},
};

/* What the compiler may call by itself. */
void *memset(void *to, int byte, size_t size) {
    for (volatile unsigned char *each = to; size > 0; size--) {
        *each++ = (unsigned char)byte;
    }
    return to;
}
