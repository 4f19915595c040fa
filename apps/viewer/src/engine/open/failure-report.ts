import {
  GpuLimitError,
  SplatFileError,
  type SplatFileErrorCode,
  SplatSourceError,
  WebSplatterError,
} from '@websplatter/core';
import { formatBytes, formatBytesOf, formatCount } from '@websplatter/kit/format';
import type { FailureReport } from '../../state/messages.ts';
import { HardCaseError } from '../link/case-addresses.ts';
import { READABLE_FORMATS } from './file-drop.ts';

/** What is wrong with a file. The engine's message adds the place in the file, and advice. */
const FILE_PROBLEMS: Readonly<Record<SplatFileErrorCode, string>> = {
  'unknown-format': 'cannot be read',
  'bad-header': 'has an unreadable header',
  'bad-property': 'has an unusable property',
  'not-splats': 'is not a Gaussian-splat scene',
  truncated: 'is incomplete',
  damaged: 'is damaged',
  'missing-part': 'needs another file',
  'bad-value': 'has a value that is not a number',
  'too-large': 'is too large',
  empty: 'has no splats',
};

/** Longer titles would not be read. */
const LONGEST_NAME = 90;

/** The report of `error`, which was thrown while `title` was being opened. */
export function reportFailure(error: unknown, title: string): FailureReport {
  if (error instanceof SplatFileError) return fileFailure(error);
  if (error instanceof SplatSourceError) {
    const advice =
      error.status === undefined
        ? 'Check the address and the connection. Another server must also allow this page to read it, by the header Access-Control-Allow-Origin (CORS).'
        : 'Check the address.';
    return { title: `${error.file} cannot be read`, message: error.message, advice };
  }
  if (error instanceof HardCaseError) {
    const { message, links } = error;
    return { title: 'No such scene', message, links };
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
    };
  }
  const message = error instanceof Error ? error.message : String(error);
  if (error instanceof WebSplatterError) return { title: `${title} cannot be shown`, message };
  return {
    title: `${title} cannot be shown`,
    message,
    advice: 'This is a fault of the viewer; the browser’s console has details.',
    isFault: true,
  };
}

function fileFailure({ code, file, message, place, found, advice }: SplatFileError): FailureReport {
  const details = message;
  if (found && found.length <= LONGEST_NAME)
    return {
      details,
      // Parentheses hold examples and counts.
      title: `${file} ${found.replaceAll(/ \([^)]*\)/g, '')}`,
      message: advice ? `${advice[0].toUpperCase()}${advice.slice(1)}.` : `Opens ${READABLE_FORMATS}.`,
    };
  if (code === 'empty' && place.byte === 0)
    return { details, title: `${file} is empty`, message: 'Check the download or the path.' };
  if (place.byte !== undefined && place.expectedBytes !== undefined) {
    const advice = 'Download or export it again.';
    const missing = place.expectedBytes - place.byte;
    // If a file lacks few bytes, both sizes would round to the same text.
    const arrived =
      missing < place.expectedBytes / 100
        ? `The last ${formatCount(missing)} bytes are missing.`
        : `${formatBytesOf(place.byte, place.expectedBytes)} arrived.`;
    return { details, title: `${file} is incomplete`, message: arrived, advice };
  }
  return { title: `${file} ${FILE_PROBLEMS[code]}`, message };
}
