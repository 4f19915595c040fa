import { CodeUnavailableError } from '../../data/errors.ts';
import type { DecodeMeshopt } from './meshopt.ts';

/** Decodes on the calling thread and fetches the decoder first. Not for workers: see `DecodeMeshopt`. */
export const decodeHere: DecodeMeshopt = async (view) => {
  try {
    const { decode } = await import('./decode-meshopt.ts');
    return await decode(view);
  } catch (cause) {
    throw new CodeUnavailableError('decoder of meshopt', { cause });
  }
};
