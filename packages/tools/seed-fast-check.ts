// Random tests try the same values in every run, unless WEBSPLATTER_SEED names others: a run never
// fails by chance.
import fc from 'fast-check';

fc.configureGlobal({ seed: Number(process.env.WEBSPLATTER_SEED ?? 1) });
