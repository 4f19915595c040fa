export type ViewerStatus =
  /** The viewer asks for a GPU. */
  | 'starting'
  | 'running'
  /** The browser has no WebGPU, or the engine's code could not be fetched. */
  | 'unavailable'
  /** The GPU was lost: nothing is drawn until it is requested again. */
  | 'lost'
  /** The viewer asks for a lost GPU again. */
  | 'recovering';

/** The GPU and its engine. */
export interface SessionState {
  readonly status: ViewerStatus;
  /** Why there is no GPU, in the browser's words. */
  readonly statusReason: string;
  /** Whether the reason is that the engine's code could not be fetched. */
  readonly isCodeMissing: boolean;
  /** Wait before the viewer asks for a lost GPU again by itself, ms; null if it does not. */
  readonly retryWaitMs: number | null;
  readonly adapterLabel: string;
}

export const FIRST_SESSION: SessionState = {
  status: 'starting',
  statusReason: '',
  isCodeMissing: false,
  retryWaitMs: null,
  adapterLabel: '',
};

/** Whether a page over the viewer says that the GPU was lost. */
export function isGpuLost({ status }: Pick<SessionState, 'status'>): boolean {
  return status === 'lost' || status === 'recovering';
}
