import { type RefObject, useRef, useState } from 'react';

/** Longest time that a browser may take to read the file it saves, ms. */
const SAVING_MS = 60_000;

/** Hands a file to the browser, which saves it under `fileName`. */
export function saveFile(file: Blob, fileName: string): void {
  const href = URL.createObjectURL(file);
  Object.assign(document.createElement('a'), { href, download: fileName }).click();
  setTimeout(() => URL.revokeObjectURL(href), SAVING_MS);
}

/** Copies reports; if the browser forbids it, the page shows the report selected in a textarea. */
export function useCopy(): {
  /** Copies `report`. @param format its name in the status, such as `JSON`. */
  readonly copy: (report: string, format: string) => Promise<void>;
  /** For an element of role `status`; empty at first. */
  readonly status: string;
  /** The report for a textarea; empty unless it could not be copied. */
  readonly uncopied: string;
  /** For the textarea, whose text is selected. */
  readonly area: RefObject<HTMLTextAreaElement | null>;
} {
  const [status, setStatus] = useState('');
  const [uncopied, setUncopied] = useState('');
  const area = useRef<HTMLTextAreaElement>(null);
  const copy = async (report: string, format: string) => {
    setUncopied('');
    try {
      await navigator.clipboard.writeText(report);
      setStatus(`Copied as ${format}`);
    } catch {
      setStatus('The browser does not let this page copy. Copy the selected text yourself.');
      setUncopied(report);
      requestAnimationFrame(() => area.current?.select());
    }
  };
  return { copy, status, uncopied, area };
}
