import { useEffect, useRef, useState } from 'react';
import { decideFiles, droppedFiles, type FileDropDecision, READABLE_FORMATS } from './file-drop.ts';
import { droppedHandles } from './file-handles.ts';

/** Takes files that are dropped anywhere in the window, and shows so while they hover. */
export function DropZone({ onDrop }: { onDrop: (decision: FileDropDecision) => void }) {
  const [isHovering, setHovering] = useState(false);
  const latestOnDrop = useRef(onDrop);
  useEffect(() => {
    latestOnDrop.current = onDrop;
  });

  useEffect(() => {
    const listeners = new AbortController();
    const { signal } = listeners;
    // Every element that the pointer crosses sends an enter and a leave; the files are gone when they balance.
    let depth = 0;
    const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') ?? false;
    const listen = (
      type: 'dragenter' | 'dragover' | 'dragleave' | 'drop',
      handler: (event: DragEvent) => void,
    ) =>
      window.addEventListener(
        type,
        (event) => {
          if (!hasFiles(event)) return;
          // Without this the browser would open the file in place of the page.
          event.preventDefault();
          handler(event);
        },
        { signal },
      );
    listen('dragenter', () => {
      depth++;
      setHovering(true);
    });
    listen('dragover', (event) => {
      if (event.dataTransfer) event.dataTransfer.dropEffect = 'copy';
    });
    listen('dragleave', () => {
      depth = Math.max(0, depth - 1);
      if (depth === 0) setHovering(false);
    });
    listen('drop', (event) => {
      depth = 0;
      setHovering(false);
      const items = [...(event.dataTransfer?.items ?? [])];
      Promise.all([droppedFiles(items), droppedHandles(items)]).then(
        ([found, handles]) => latestOnDrop.current({ ...decideFiles(found), handles }),
        (error) => latestOnDrop.current({ opened: null, notice: `The folder cannot be read: ${error}` }),
      );
    });
    return () => listeners.abort();
  }, []);

  return (
    <div className="drop-overlay" data-testid="drop-overlay" hidden={!isHovering}>
      <p>
        <strong>Drop to open</strong>
        <span>A Gaussian-splat scene: {READABLE_FORMATS}</span>
      </p>
    </div>
  );
}
