// Numbers for a reader: prefixes, round values, axis ticks.

// Factor and letter of the SI prefix that puts a value, to three figures, between 1 and 1000 (as in app/format.py).
const PREFIXES = [..."GMk mµnpfa"].map((letter, i) => [10 ** (9 - 3 * i), letter.trim()]);
export const prefixed = (value) => PREFIXES.find(([factor]) => Math.abs(value) >= 0.9995 * factor) ?? [1, ""];

export const round3 = (value) => Number(value.toPrecision(3));

// The round numbers of a decade, and the nearest one below or above a value.
const STEPS = [1, 2, 5, 10];
const inDecade = (value, pick) => {
  const power = 10 ** Math.floor(Math.log10(value));
  return pick((step) => step * power) * power;
};
export const stepBelow = (value) => inDecade(value, (of) => STEPS.findLast((step) => of(step) <= value) ?? 1);
const stepAbove = (value) => inDecade(value, (of) => STEPS.find((step) => of(step) >= value) ?? 10);

// About `count` round values between low and high.
export function ticks(low, high, count) {
  const step = stepAbove((high - low) / count);
  const values = [];
  for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) values.push(Number(v.toPrecision(6)));
  return values;
}
