// Factors from 0 to GREATEST_FACTOR as codes of ten bits, by their square root: dark factors need finer steps.
// A pixel that shows a quarter of its own surface beside black ones has a factor of 4.

// The code of a factor of 1, which is stored exactly, and the greatest one.
const CODE_OF_ONE: f32 = 512.0;
const GREATEST_CODE: f32 = 1023.0;
const GREATEST_FACTOR: f32 = (GREATEST_CODE / CODE_OF_ONE) * (GREATEST_CODE / CODE_OF_ONE);

fn coded_factor(factor: vec3f) -> vec3f {
  return min(sqrt(factor) * CODE_OF_ONE / GREATEST_CODE, vec3f(1.0));
}

fn factor_of_code(coded: vec3f) -> vec3f {
  let root = coded * (GREATEST_CODE / CODE_OF_ONE);
  return root * root;
}
