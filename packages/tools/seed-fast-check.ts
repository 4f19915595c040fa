// Property tests use the same values in every run, unless WEBSPLATTER_SEED is set: a run never
// fails by chance.
import fc from 'fast-check';

fc.configureGlobal({ seed: Number(process.env.WEBSPLATTER_SEED ?? 1) });
