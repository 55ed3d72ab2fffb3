/* What the example needs of a machine: Arm's AN386 in QEMU, which prints over semihosting. */
#ifndef PORT_H
#define PORT_H

#include <stdint.h>

/* The bytes of table.bin, as the linker laid them. */
extern const uint8_t port_table[];
extern const uint8_t port_table_end[];

/* A line of text. */
void port_print(const char *text);
/* A line: a letter and four numbers in hexadecimal, floats as their bits. */
void port_print_bits(char letter, float first, float second, uint32_t third, uint32_t fourth);
/* A line: how many bytes of stack have been used since the start. */
void port_print_stack(void);

#endif
