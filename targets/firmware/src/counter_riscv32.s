# Calls of a step on RV32. a0: step, and six arguments.
    .section .text.hexagen_counter, "ax", @progbits

    .global hexagen_counted_call
    .type hexagen_counted_call, @function
    .balign 4
hexagen_counted_call:
    addi sp, sp, -16
    sw ra, 12(sp)
    sw s0, 8(sp)
    lw t0, 0(a0)
    lw a1, 8(a0)
    lw a2, 12(a0)
    lw a3, 16(a0)
    lw a4, 20(a0)
    lw a5, 24(a0)
    lw a0, 4(a0)
    csrr s0, minstret
    jalr t0
    csrr a0, minstret
    sub a0, a0, s0
    lw s0, 8(sp)
    lw ra, 12(sp)
    addi sp, sp, 16
    ret
    .size hexagen_counted_call, . - hexagen_counted_call

    .global hexagen_sounded_call
    .type hexagen_sounded_call, @function
    .balign 4
hexagen_sounded_call:
    addi sp, sp, -16
    sw ra, 12(sp)
    sw s0, 8(sp)
    li s0, 0x5ca1ab1e           # Paints 1024 bytes below the stack pointer.
    addi t1, sp, -1024
1:  sw s0, 0(t1)
    addi t1, t1, 4
    bne t1, sp, 1b
    lw t0, 0(a0)
    lw a1, 8(a0)
    lw a2, 12(a0)
    lw a3, 16(a0)
    lw a4, 20(a0)
    lw a5, 24(a0)
    lw a0, 4(a0)
    jalr t0
    addi t1, sp, -1024          # Looks for the lowest word that is not paint.
2:  lw t2, 0(t1)
    bne t2, s0, 3f
    addi t1, t1, 4
    bne t1, sp, 2b
3:  sub a0, sp, t1
    lw s0, 8(sp)
    lw ra, 12(sp)
    addi sp, sp, 16
    ret
    .size hexagen_sounded_call, . - hexagen_sounded_call

    .global hexagen_empty_step
    .type hexagen_empty_step, @function
    .balign 4
hexagen_empty_step:
    ret
    .size hexagen_empty_step, . - hexagen_empty_step

# 64 instructions, counted by hand: 1 + 31 * 2 + 1.
    .global hexagen_known_step
    .type hexagen_known_step, @function
    .balign 4
hexagen_known_step:
    li t0, 31
1:  addi t0, t0, -1
    bnez t0, 1b
    ret
    .size hexagen_known_step, . - hexagen_known_step
