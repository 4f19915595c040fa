import { CodeUnavailableError } from '../../data/errors.ts';
import type { DecodeMeshopt } from '../containers/meshopt.ts';
import { ALL_READERS } from './readers.ts';
import type { FormatReaders } from './splat-format.ts';

/** Unpacks on the calling thread, by code that it fetches. Not for workers: see `DecodeMeshopt`. */
export const decodeHere: DecodeMeshopt = async (view) => {
  try {
    const { decode } = await import('../containers/decode-meshopt.ts');
    return await decode(view);
  } catch (cause) {
    throw new CodeUnavailableError('decoder of meshopt', { cause });
  }
};

/** All formats, for threads that may fetch code. */
export const THREAD_READERS: FormatReaders = { ...ALL_READERS, decodeMeshopt: decodeHere };
