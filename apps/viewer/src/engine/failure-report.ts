import {
  GpuLimitError,
  SplatFileError,
  type SplatFileErrorCode,
  SplatSourceError,
  WebSplatterError,
} from '@websplatter/core';
import { formatBytes, formatBytesOf, formatCount } from '@websplatter/kit/format';
import type { FailureReport } from '../state/messages.ts';
import { HardCaseError } from './case-addresses.ts';
import { READABLE_FORMATS } from './file-drop.ts';

/** The engine's message adds the place in the file, and advice. */
const FILE_PROBLEMS: Readonly<Record<Exclude<SplatFileErrorCode, 'unknown-format'>, string>> = {
  'bad-header': 'The file’s header cannot be read',
  'bad-property': 'The file has an unusable property',
  'not-splats': 'Not a Gaussian-splat scene',
  truncated: 'The file is incomplete',
  damaged: 'The file is damaged',
  'missing-part': 'A file of the scene is missing',
  'bad-value': 'The file holds a value that is no number',
  'too-large': 'The file is too large',
  empty: 'The file has no splats',
};

/** The report of `error`, which was thrown while `title` was being opened. */
export function reportFailure(error: unknown, title: string): FailureReport {
  if (error instanceof SplatFileError) return fileFailure(error);
  if (error instanceof SplatSourceError) {
    const advice =
      error.status === undefined
        ? 'Check the address and the connection; the server must allow reading from this page (CORS).'
        : 'Check the address.';
    return { title: 'The file cannot be read', message: error.message, advice, isFault: false };
  }
  if (error instanceof HardCaseError) {
    const { message, links } = error;
    return { title: 'No such scene', message, advice: '', isFault: false, links };
  }
  if (error instanceof GpuLimitError) {
    const sizes = `${formatBytes(error.neededBytes)} needed, ${formatBytes(error.availableBytes)} available`;
    // Texture limits are in pixels although their names say bytes; WebGPU does not report the
    // memory size.
    const hasSizes = !error.limit.includes('Dimension') && error.limit !== 'memory';
    return {
      title: 'Too large for this GPU',
      message: hasSizes ? `${error.message} (${sizes})` : error.message,
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

function fileFailure({ code, file, message, place }: SplatFileError): FailureReport {
  const plain = { advice: '', details: message, isFault: false };
  if (code === 'unknown-format') {
    // Messages about a web page or an encrypted archive say more.
    if (!message.includes('of no known format'))
      return { title: `${file} cannot be read`, message, advice: '', isFault: false };
    return { ...plain, title: `${file} is not a splat file`, message: `Opens ${READABLE_FORMATS}.` };
  }
  if (code === 'empty' && place.byte === 0)
    return { ...plain, title: `${file} is empty`, message: 'Check the download or the path.' };
  if (place.byte !== undefined && place.expectedBytes !== undefined) {
    const advice = 'Download or export it again.';
    const missing = place.expectedBytes - place.byte;
    // If a file lacks few bytes, both sizes would round to the same text.
    const arrived =
      missing < place.expectedBytes / 100
        ? `The last ${formatCount(missing)} bytes are missing.`
        : `${formatBytesOf(place.byte, place.expectedBytes)} arrived.`;
    return { ...plain, title: `${file} is incomplete`, message: arrived, advice };
  }
  return { title: FILE_PROBLEMS[code], message, advice: '', isFault: false };
}

/** Report on several files that could not be opened. */
export function joinedFailures(failures: readonly FailureReport[]): FailureReport {
  if (failures.length === 1) return failures[0];
  return {
    title: `${failures.length} files cannot be opened`,
    message: failures.map(({ title, message }) => `${title}: ${message}`).join(' '),
    advice: '',
    isFault: failures.some(({ isFault }) => isFault),
  };
}
