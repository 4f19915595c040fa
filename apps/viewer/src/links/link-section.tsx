import { useStore } from 'zustand';
import { TextButton } from '../ui/controls.tsx';
import { Icon } from '../ui/icon.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { copyLink, linkOf, noLink } from './copy-link.ts';

/** A link to the present view: to be read, and to be copied. */
export function LinkSection({ store, viewer }: PanelProps) {
  // The link changes with these; a moving camera is told when it is at rest.
  useStore(store, ({ restedFrames }) => restedFrames);
  useStore(store, ({ scene }) => scene);
  useStore(store, ({ splitPart }) => splitPart);
  const link = linkOf(viewer, store);
  return (
    <section className="link-section">
      <h3 id="link-title">Link</h3>
      {link === null ? (
        <p>{noLink(viewer)}</p>
      ) : (
        <div className="link-row">
          <input
            type="text"
            readOnly
            value={link}
            aria-labelledby="link-title"
            data-testid="link"
            onFocus={(event) => event.target.select()}
          />
          <TextButton look="primary" testId="copy-link" onClick={() => void copyLink(viewer, store)}>
            <Icon name="link" />
            Copy
          </TextButton>
        </div>
      )}
    </section>
  );
}
