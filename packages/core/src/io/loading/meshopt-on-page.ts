import { CodeUnavailableError } from '../../data/errors.ts';
import type { DecodeMeshopt } from '../containers/meshopt.ts';
import { toPostedError } from '../posted-error.ts';
import type { LoadReply, UnpackedReply } from './serve-load.ts';

/** Decodes on the calling thread and fetches the decoder first. Not for workers: see `DecodeMeshopt`. */
export const decodeHere: DecodeMeshopt = async (view) => {
  try {
    const { decode } = await import('../containers/decode-meshopt.ts');
    return await decode(view);
  } catch (cause) {
    throw new CodeUnavailableError('decoder of meshopt', { cause });
  }
};

/** Unpacks a view for a worker that waits in `withPageDecoder`. */
export async function answerPackedView({
  view,
  reply,
}: Extract<LoadReply, { kind: 'packed-view' }>): Promise<void> {
  const answer = (message: UnpackedReply, transfer: Transferable[]) => reply.postMessage(message, transfer);
  try {
    const bytes = await decodeHere(view);
    answer({ bytes }, bytes ? [bytes.buffer] : []);
  } catch (error) {
    answer({ error: toPostedError(error) }, []);
  }
}
