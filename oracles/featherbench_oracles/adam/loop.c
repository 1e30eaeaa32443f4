/* The loop over states that is timed, compiled together with the code that CasADi generates for one quantity of one robot. */
#include <stddef.h>
#include <stdint.h>
#include <time.h>

/* What CasADi generates: arguments, results and two arrays of work. */
int evaluate(const double **argument, double **result, long long *integers, double *numbers, int memory);

static int64_t now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

/* Evaluates `count` states from `first` on, one after the other. Beyond the end of the batch they begin again. `input[i]` holds the numbers of
 * argument i, `size[i]` for each state; `argument` has room for all that `evaluate_work` asks. Returns the nanoseconds of the loop, or -1 where
 * the generated code fails. */
int64_t run(size_t inputs, const double *const *input, const size_t *size, size_t states, size_t first, size_t count, const double **argument,
            double **result, long long *integers, double *numbers) {
  const int64_t start = now();
  size_t k = first % states;
  for (size_t n = 0; n < count; n++) {
    for (size_t i = 0; i < inputs; i++) argument[i] = input[i] + k * size[i];
    if (evaluate(argument, result, integers, numbers, 0)) return -1;
    if (++k == states) k = 0;
  }
  return now() - start;
}
