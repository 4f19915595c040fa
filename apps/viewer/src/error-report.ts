import {
  GpuLimitError,
  SplatFileError,
  type SplatFileErrorCode,
  SplatSourceError,
  WebSplatterError,
} from '@websplatter/core';
import { formatBytes } from './format.ts';

/** An error as it is shown: what went wrong in a few words, the particulars, and what to do. */
export interface ErrorReport {
  readonly title: string;
  readonly message: string;
  readonly advice: string;
  /** Nothing that the engine throws on purpose: a mistake of ours, whose particulars belong in the console. */
  readonly isFault: boolean;
}

const FILE_PROBLEMS: Readonly<Record<SplatFileErrorCode, { title: string; advice: string }>> = {
  'unknown-format': {
    title: 'Unknown file format',
    advice: 'Open a Gaussian-splat scene as a PLY file, as training tools write it.',
  },
  'bad-header': {
    title: 'The file’s header cannot be read',
    advice: 'Export the scene again, or check how it was edited.',
  },
  'bad-property': {
    title: 'The file has an unusable property',
    advice: 'Export the scene again with the standard properties.',
  },
  'not-splats': {
    title: 'Not a Gaussian-splat scene',
    advice:
      'This is a point cloud or a mesh. Open the PLY that training wrote, with scale_*, rot_*, f_dc_* and opacity.',
  },
  truncated: { title: 'The file is incomplete', advice: 'Copy or download it again: its end is missing.' },
  'bad-value': {
    title: 'The file holds a value that is no number',
    advice: 'Export the scene again, as binary if possible.',
  },
  'too-large': { title: 'Too many splats', advice: 'Reduce the scene, or split it into several files.' },
  empty: { title: 'The file has no splats', advice: 'Check the export: the file is well formed but empty.' },
};

/** What to tell about `error`, which arose while `title` was being opened. */
export function reportError(error: unknown, title: string): ErrorReport {
  if (error instanceof SplatFileError)
    return { ...FILE_PROBLEMS[error.code], message: error.message, isFault: false };
  if (error instanceof SplatSourceError) {
    const advice =
      error.status === undefined
        ? 'Check the address and the connection; the server must allow reading from this page (CORS).'
        : 'Check the address.';
    return { title: 'The file cannot be read', message: error.message, advice, isFault: false };
  }
  if (error instanceof GpuLimitError) {
    const sizes = `${formatBytes(error.neededBytes)} needed, ${formatBytes(error.availableBytes)} available`;
    return {
      title: 'Too large for this GPU',
      message: `${error.message} (${sizes})`,
      advice: 'Open a smaller scene, or use a GPU with larger limits.',
      isFault: false,
    };
  }
  const message = error instanceof Error ? error.message : String(error);
  if (error instanceof WebSplatterError)
    return { title: `${title} cannot be shown`, message, advice: '', isFault: false };
  return {
    title: `${title} cannot be shown`,
    message,
    advice: 'This is a fault of the viewer; the browser’s console has the particulars.',
    isFault: true,
  };
}
