// The Mersenne Twister MT19937 with its reference seeding: the same numbers as in Python for the same seed.

const SIZE = 624;
const SHIFT = 397;

/** A function that returns uniform doubles in [0, 1) with 53 random bits. */
export function uniformFrom(seed) {
  const state = new Uint32Array(SIZE);
  state[0] = seed;
  for (let k = 1; k < SIZE; k++) {
    const previous = state[k - 1] ^ (state[k - 1] >>> 30);
    state[k] = Math.imul(1812433253, previous) + k;
  }
  let next = SIZE;

  function renew() {
    for (let k = 0; k < SIZE; k++) {
      const word = (state[k] & 0x80000000) | (state[(k + 1) % SIZE] & 0x7fffffff);
      state[k] = state[(k + SHIFT) % SIZE] ^ (word >>> 1) ^ (word & 1 ? 0x9908b0df : 0);
    }
    next = 0;
  }

  function integer() {
    if (next === SIZE) renew();
    let word = state[next++];
    word ^= word >>> 11;
    word ^= (word << 7) & 0x9d2c5680;
    word ^= (word << 15) & 0xefc60000;
    return (word ^ (word >>> 18)) >>> 0;
  }

  return () => ((integer() >>> 5) * 67108864 + (integer() >>> 6)) / 9007199254740992;
}

/**
 * Draws that a camera's noise is made of: for each sample as many as its kind needs, then one a sample for its loss.
 */
export function draws(kind, seed, samples, outputs) {
  const uniform = uniformFrom(seed);
  const shape = new Float64Array(samples * outputs);
  for (let k = 0; k < shape.length; k++) {
    shape[k] = kind === "uniform" ? uniform() : boxMuller(uniform(), uniform());
  }
  const loss = Float64Array.from({ length: samples }, uniform);
  return { shape, loss };
}

function boxMuller(first, second) {
  return Math.sqrt(-2 * Math.log1p(-first)) * Math.cos(2 * Math.PI * second);
}
