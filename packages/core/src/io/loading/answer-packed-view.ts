import { decodeHere } from '../containers/decode-here.ts';
import { toPostedError } from '../posted-error.ts';
import type { LoadReply, UnpackedReply } from './load-messages.ts';

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
