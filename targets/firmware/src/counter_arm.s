@ Calls of a step on ARMv6-M and above. r0: step, and six arguments.
    .syntax unified
    .thumb
    .section .text.hexagen_counter, "ax", %progbits

    .global hexagen_counted_call
    .type hexagen_counted_call, %function
    .thumb_func
    .balign 4
hexagen_counted_call:
    push {{r4, r5, r6, lr}}
    sub sp, #8
    mov r4, r0
    ldr r0, [r4, #20]
    str r0, [sp]
    ldr r0, [r4, #24]
    str r0, [sp, #4]
    ldr r6, [r4]
    ldr r5, =0xe000e018         @ SysTick's current value: counts down.
    ldr r0, [r4, #4]
    ldr r1, [r4, #8]
    ldr r2, [r4, #12]
    ldr r3, [r4, #16]
    ldr r4, [r5]
    blx r6
    ldr r5, [r5]
    subs r0, r4, r5
    add sp, #8
    pop {{r4, r5, r6, pc}}
    .ltorg
    .size hexagen_counted_call, . - hexagen_counted_call

    .global hexagen_sounded_call
    .type hexagen_sounded_call, %function
    .thumb_func
    .balign 4
hexagen_sounded_call:
    push {{r4, r5, r6, lr}}
    sub sp, #8
    mov r4, r0
    ldr r0, [r4, #20]
    str r0, [sp]
    ldr r0, [r4, #24]
    str r0, [sp, #4]
    ldr r6, [r4]
    ldr r5, =0x5ca1ab1e         @ Paints 1024 bytes below the stack pointer.
    mov r1, sp
    movs r2, #255
    adds r2, r2, #1
1:  subs r1, r1, #4
    str r5, [r1]
    subs r2, r2, #1
    bne 1b
    ldr r0, [r4, #4]
    ldr r1, [r4, #8]
    ldr r2, [r4, #12]
    ldr r3, [r4, #16]
    blx r6
    mov r0, sp                  @ Looks for the lowest word that is not paint.
    ldr r1, =1024
    subs r1, r0, r1
2:  ldr r2, [r1]
    cmp r2, r5
    bne 3f
    adds r1, r1, #4
    cmp r1, r0
    bne 2b
3:  subs r0, r0, r1
    add sp, #8
    pop {{r4, r5, r6, pc}}
    .ltorg
    .size hexagen_sounded_call, . - hexagen_sounded_call

    .global hexagen_empty_step
    .type hexagen_empty_step, %function
    .thumb_func
    .balign 4
hexagen_empty_step:
    bx lr
    .size hexagen_empty_step, . - hexagen_empty_step

@ 64 instructions, counted by hand: 1 + 31 * 2 + 1.
    .global hexagen_known_step
    .type hexagen_known_step, %function
    .thumb_func
    .balign 4
hexagen_known_step:
    movs r0, #31
1:  subs r0, #1
    bne 1b
    bx lr
    .size hexagen_known_step, . - hexagen_known_step
