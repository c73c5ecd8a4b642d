/* A stand-in for Objective-C: one message that returns known matrices in vector registers, as clang has it. */
#include <arm_neon.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct { float32x4_t columns[4]; } matrix4;
typedef struct { float32x4_t columns[3]; } matrix3;

static int n_wrong;

static void expect(int is_right, const char *what) {
    if (!is_right) {
        printf("wrong: %s\n", what);
        n_wrong++;
    }
}

static float32x4_t column(int index) {
    float lanes[4] = {10 * index + 1, 10 * index + 2, 10 * index + 3, 10 * index + 4};
    return vld1q_f32(lanes);
}

/* 0 asks for four columns, 1 for three, 2 hands four over. */
int message;

matrix4 send4(void *object, void *selector) {
    expect(object == (void *)0x1234 && selector == (void *)0x5678, "arguments");
    matrix4 matrix = {{column(0), column(1), column(2), column(3)}};
    return matrix;
}

matrix3 send3(void *object, void *selector) {
    expect(object == (void *)0x1234 && selector == (void *)0x5678, "arguments");
    matrix3 matrix = {{column(5), column(6), column(7)}};
    return matrix;
}

void *take4(void *object, void *selector, matrix4 matrix) {
    expect(object == (void *)0x1234 && selector == (void *)0x5678, "arguments");
    for (int index = 0; index < 16; index++) {
        float number = matrix.columns[index / 4][index % 4];
        expect(number == 10 * (index / 4) + index % 4 + 1, "a number that is handed over");
    }
    return (void *)0x9abc;
}

/* A jump, so that whatever the callee leaves in the registers is what the caller finds. */
__attribute__((naked)) void objc_msgSend(void) {
    __asm__("adrp x9, message\n\tldr w9, [x9, :lo12:message]\n\tcbz w9, send4\n\tcmp w9, 1\n\tb.eq send3\n\tb take4");
}

void ask_for_four(void *object, void *selector, float *to);
void ask_for_four_without(void *object, void *selector, float *to);
void ask_for_three(void *object, void *selector, float *to);
void *hand_over_four(void *object, void *selector, const float *from);

int main(void) {
    struct { float before[4]; float matrix[16]; float after[4]; } four __attribute__((aligned(16)));
    struct { float before[4]; float matrix[12]; float after[4]; } three __attribute__((aligned(16)));
    void *object = (void *)0x1234, *selector = (void *)0x5678;

    memset(&four, 0xee, sizeof four);
    ask_for_four(object, selector, four.matrix);
    for (int index = 0; index < 16; index++) {
        expect(four.matrix[index] == 10 * (index / 4) + index % 4 + 1, "a number of four columns");
    }
    expect(!memcmp(four.before, four.after, sizeof four.before), "what lies around four columns");

    message = 1;
    memset(&three, 0xee, sizeof three);
    ask_for_three(object, selector, three.matrix);
    for (int index = 0; index < 12; index++) {
        expect(three.matrix[index] == 10 * (5 + index / 4) + index % 4 + 1, "a number of three columns");
    }
    expect(!memcmp(three.before, three.after, sizeof three.before), "what lies around three columns");

    message = 2;
    for (int index = 0; index < 16; index++) {
        four.matrix[index] = 10 * (index / 4) + index % 4 + 1;
    }
    expect(hand_over_four(object, selector, four.matrix) == (void *)0x9abc, "the answer");

    /* Without the shim the numbers must not arrive, or the test would prove nothing. */
    message = 0;
    memset(&four, 0, sizeof four);
    ask_for_four_without(object, selector, four.matrix);
    expect(four.matrix[5] != 12, "the control");

    printf("%d wrong\n", n_wrong);
    return n_wrong != 0;
}
