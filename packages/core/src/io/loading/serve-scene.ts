import { Turns } from '../../data/turns.ts';
import type { SceneTasks } from '../formats/scene-tasks.ts';
import { type PostedError, toPostedError } from '../posted-error.ts';

type TaskName = keyof SceneTasks;

/** Input and output of a task. */
export type TaskInput<Name extends TaskName> = Parameters<SceneTasks[Name]>[0];
export type TaskResult<Name extends TaskName> = Awaited<ReturnType<SceneTasks[Name]>>;

/** Page to worker. */
export type SceneRequest =
  | {
      readonly task: TaskName;
      /** Id of the request; the reply has the same. */
      readonly id: number;
      readonly input: TaskInput<TaskName>;
    }
  /** Cancels the request with this id. */
  | { readonly task: 'drop'; readonly id: number };

/** Worker to page. */
export type SceneReply =
  /** The worker's script is running. */
  | { readonly kind: 'ready' }
  | { readonly kind: 'done'; readonly id: number; readonly result: TaskResult<TaskName> }
  | { readonly kind: 'error'; readonly id: number; readonly error: PostedError };

/** The used part of a worker's global scope; a MessagePort has it too. */
export interface ScenePort {
  onmessage: ((event: MessageEvent<SceneRequest>) => void) | null;
  postMessage(reply: SceneReply, transfer: Transferable[]): void;
}

/** Serves the task requests of a page, one after another. */
export function serveScene(port: ScenePort, tasks: SceneTasks): void {
  /** Abort controllers of pending requests, by id. */
  const endings = new Map<number, AbortController>();
  let last: Promise<void> = Promise.resolve();
  const answer = async (request: Exclude<SceneRequest, { task: 'drop' }>, signal: AbortSignal) => {
    const { id, task, input } = request;
    try {
      signal.throwIfAborted();
      const result = await tasks[task](input as never, new Turns(signal));
      const { geometry, harmonics, rows } = result;
      port.postMessage(
        { kind: 'done', id, result },
        [geometry, harmonics, rows].map(({ buffer }) => buffer),
      );
    } catch (error) {
      port.postMessage({ kind: 'error', id, error: toPostedError(error) }, []);
    } finally {
      endings.delete(id);
    }
  };
  port.onmessage = ({ data: request }) => {
    if (request.task === 'drop') {
      endings.get(request.id)?.abort();
      return;
    }
    const ending = new AbortController();
    endings.set(request.id, ending);
    last = last.then(() => answer(request, ending.signal));
  };
  port.postMessage({ kind: 'ready' }, []);
}
