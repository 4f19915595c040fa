import { CodeUnavailableError } from '../../data/errors.ts';
import type { DecodeMeshopt } from './meshopt.ts';

/** Unpacks on the calling thread, by code that it fetches. Not for workers: see `DecodeMeshopt`. */
export const decodeHere: DecodeMeshopt = async (view) => {
  try {
    const { decode } = await import('./decode-meshopt.ts');
    return await decode(view);
  } catch (cause) {
    throw new CodeUnavailableError('decoder of meshopt', { cause });
  }
};
