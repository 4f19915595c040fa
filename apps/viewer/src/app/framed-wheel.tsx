import './framed-wheel.css';
import { useEffect, useState } from 'react';
import type { ViewerStore } from '../state/store.ts';
import { ZOOM_KEY } from '../ui/zoom-key.ts';

/** Long enough to be read, ms. */
const HINT_MS = 2000;

/**
 * In a frame, a plain wheel scrolls the page around it, as over maps, and one finger does along the
 * page; with Ctrl or ⌘, in full screen and in flight, the wheel is the picture's.
 */
export function FramedWheel({ store }: { store: ViewerStore }) {
  const [isHinted, setHinted] = useState(false);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    const onWheel = (event: WheelEvent) => {
      const isOfPicture =
        event.ctrlKey || event.metaKey || document.fullscreenElement || store.getState().travelling;
      if (isOfPicture || (event.target as Element).closest('.panel')) {
        setHinted(false);
        return;
      }
      // Keeps the event from the picture, whose handler would zoom and prevent the page from scrolling.
      event.stopPropagation();
      setHinted(true);
      clearTimeout(timer);
      timer = setTimeout(() => setHinted(false), HINT_MS);
    };
    const { dataset } = document.documentElement;
    dataset.framed = '';
    addEventListener('wheel', onWheel, { capture: true, passive: true });
    return () => {
      delete dataset.framed;
      removeEventListener('wheel', onWheel, { capture: true });
      clearTimeout(timer);
    };
  }, [store]);
  return (
    <div className="over-picture framed-hint" role="status">
      {isHinted && (
        <p className="panel" data-testid="wheel-hint">
          Use {ZOOM_KEY} + scroll to zoom
        </p>
      )}
    </div>
  );
}
