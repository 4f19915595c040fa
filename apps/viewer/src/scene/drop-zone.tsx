import { useEffect, useRef, useState } from 'react';
import { decide } from '../engine/decide.ts';
import { droppedFiles, type FileDropDecision, READABLE_FORMATS } from '../engine/file-drop.ts';
import { droppedHandles } from '../engine/file-handles.ts';

/** Whether dropped files replace the scene or are added to it. */
type DropAim = 'open' | 'add';

/**
 * Accepts files dropped anywhere in the window, with an overlay while they hover.
 *
 * @param canAdd whether files may be added to the scene: on a target of its own, or with Shift.
 */
export function DropZone({
  canAdd = false,
  onDrop,
}: {
  canAdd?: boolean;
  onDrop: (decision: FileDropDecision) => void;
}) {
  const [aim, setAim] = useState<DropAim | null>(null);
  const addArea = useRef<HTMLParagraphElement>(null);
  const latestOnDrop = useRef(onDrop);
  useEffect(() => {
    latestOnDrop.current = onDrop;
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
    const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
    const listen = (
      type: 'dragenter' | 'dragover' | 'dragleave' | 'drop',
      handler: (event: DragEvent) => void,
    ) =>
      window.addEventListener(
        type,
        (event) => {
          if (!hasFiles(event)) return;
          // Prevents the browser from opening the file instead of the page.
          event.preventDefault();
          handler(event);
        },
        { signal },
      );
    listen('dragenter', (event) => {
      depth++;
      setAim(aimOf(event));
    });
    listen('dragover', (event) => {
      setAim(aimOf(event));
      if (event.dataTransfer) event.dataTransfer.dropEffect = 'copy';
    });
    listen('dragleave', () => {
      depth = Math.max(0, depth - 1);
      if (depth === 0) setAim(null);
    });
    listen('drop', (event) => {
      depth = 0;
      const isAdded = aimOf(event) === 'add';
      setAim(null);
      const items = [...(event.dataTransfer?.items ?? [])];
      Promise.all([droppedFiles(items).then(decide), droppedHandles(items)]).then(
        ([decision, handles]) => latestOnDrop.current({ ...decision, isAdded, handles }),
        (error) => latestOnDrop.current({ opened: [], notice: `What was dropped cannot be read: ${error}` }),
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
