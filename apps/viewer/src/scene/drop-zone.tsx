import { useEffect, useRef, useState } from 'react';
import { decide } from '../engine/open/decide.ts';
import {
  droppedFiles,
  droppedHandles,
  type FileDropDecision,
  READABLE_FORMATS,
} from '../engine/open/file-drop.ts';

/** Type of dragged links. */
const LINKS = 'text/uri-list';

/** Whether dropped files replace the scene or are added to it. */
type DropAim = 'open' | 'add';

/**
 * Accepts files dropped anywhere in the window, with an overlay while they hover.
 *
 * @param onLink called with a dropped link; without it, links are not accepted.
 * @param canAdd whether files may be added to the scene: on a target of its own, or with Shift.
 */
export function DropZone({
  canAdd = false,
  onDrop,
  onLink,
}: {
  canAdd?: boolean;
  onDrop: (decision: FileDropDecision) => void;
  onLink?: (text: string, isAdded: boolean) => void;
}) {
  const [aim, setAim] = useState<DropAim | null>(null);
  const addArea = useRef<HTMLParagraphElement>(null);
  const latest = useRef({ onDrop, onLink });
  useEffect(() => {
    latest.current = { onDrop, onLink };
  });

  useEffect(() => {
    const listeners = new AbortController();
    const { signal } = listeners;
    // Every element under the pointer sends enter and leave events; the drag has left when they
    // balance.
    let depth = 0;
    const aimOf = ({ shiftKey, clientX, clientY }: DragEvent): DropAim => {
      const area = addArea.current?.getBoundingClientRect();
      if (!area) return 'open';
      const isOver =
        clientX >= area.left && clientX < area.right && clientY >= area.top && clientY < area.bottom;
      return shiftKey || isOver ? 'add' : 'open';
    };
    // A link of this page that is dragged over it is not meant to be opened.
    let isOwn = false;
    addEventListener(
      'dragstart',
      () => {
        isOwn = true;
      },
      { signal },
    );
    addEventListener(
      'dragend',
      () => {
        isOwn = false;
      },
      { signal },
    );
    const isAccepted = ({ dataTransfer }: DragEvent) => {
      const types = dataTransfer?.types ?? [];
      return types.includes('Files') || (!isOwn && !!latest.current.onLink && types.includes(LINKS));
    };
    const listen = (
      type: 'dragenter' | 'dragover' | 'dragleave' | 'drop',
      handler: (event: DragEvent, isTaken: boolean) => void,
    ) =>
      window.addEventListener(
        type,
        (event) => {
          if (!isAccepted(event)) return;
          // An element that takes files itself has prevented it before.
          const isTaken = event.defaultPrevented;
          // Prevents the browser from opening the file instead of the page.
          event.preventDefault();
          handler(event, isTaken);
        },
        { signal },
      );
    listen('dragenter', (event, isTaken) => {
      depth++;
      setAim(isTaken ? null : aimOf(event));
    });
    listen('dragover', (event, isTaken) => {
      setAim(isTaken ? null : aimOf(event));
      if (event.dataTransfer) event.dataTransfer.dropEffect = 'copy';
    });
    listen('dragleave', () => {
      depth = Math.max(0, depth - 1);
      if (depth === 0) setAim(null);
    });
    listen('drop', (event, isTaken) => {
      depth = 0;
      const isAdded = aimOf(event) === 'add';
      setAim(null);
      if (isTaken) return;
      const link = event.dataTransfer?.getData(LINKS);
      if (link && !event.dataTransfer?.types.includes('Files')) {
        latest.current.onLink?.(link, isAdded);
        return;
      }
      const items = [...(event.dataTransfer?.items ?? [])];
      Promise.all([droppedFiles(items).then(decide), droppedHandles(items)]).then(
        ([decision, handles]) => latest.current.onDrop({ ...decision, isAdded, handles }),
        (error) => latest.current.onDrop({ opened: [], notice: `What was dropped cannot be read: ${error}` }),
      );
    });
    return () => listeners.abort();
  }, []);

  return (
    <div className="drop-overlay" data-testid="drop-overlay" hidden={aim === null}>
      <p data-aimed={aim === 'open'}>
        <strong>Drop to open</strong>
        <span>Gaussian-splat scenes: {READABLE_FORMATS}</span>
      </p>
      {canAdd && (
        <p ref={addArea} data-aimed={aim === 'add'} data-testid="drop-add">
          <strong>Drop to add</strong>
          <span>Beside what is shown; anywhere with Shift</span>
        </p>
      )}
    </div>
  );
}
