import { TextButton } from '@websplatter/kit/controls';
import { Icon } from '@websplatter/kit/icon';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { escaped } from '../ui/html.ts';
import { copyFrame, copyLink, lackingInLinks, linkOf, noLink } from './copy-link.ts';

/** A link to the present view, and a frame of it for other pages: to be read, and to be copied. */
export function LinkSection({ store, viewer }: PanelProps) {
  // The link changes with these; a moving camera is told when it is at rest.
  useStore(store, ({ restedFrames }) => restedFrames);
  useStore(store, ({ splitPart }) => splitPart);
  useStore(store, ({ annotating }) => annotating.list);
  const scene = useStore(store, (state) => state.scene);
  const lacking = useStore(store, lackingInLinks);
  const link = linkOf(viewer, store);
  if (link === null)
    return (
      <section className="link-section">
        <h3>Link</h3>
        <p>{noLink(viewer)}</p>
      </section>
    );
  const frame = frameText(link, scene?.title ?? '');
  return (
    <>
      <LinkField
        name="link"
        title="Link"
        look="primary"
        text={link}
        onCopy={() => void copyLink(viewer, store)}
      />
      <LinkField
        name="frame"
        title="Embed code (iframe)"
        look="outlined"
        text={frame}
        onCopy={() => void copyFrame(frame, store)}
      />
      {lacking && <p data-testid="link-lacks">Link and embed code show this view {lacking}</p>}
    </>
  );
}

/** A text that is to be copied; it wraps, so that all of it can be read. */
function LinkField({
  name,
  title,
  look,
  text,
  onCopy,
}: {
  name: 'link' | 'frame';
  title: string;
  look: 'primary' | 'outlined';
  text: string;
  onCopy: () => void;
}) {
  return (
    <section className="link-section">
      <div className="spread">
        <h3 id={`${name}-title`}>{title}</h3>
        <TextButton
          look={look}
          aria-label={`Copy the ${title.toLowerCase()}`}
          testId={`copy-${name}`}
          onClick={onCopy}
        >
          <Icon name="link" />
          Copy
        </TextButton>
      </div>
      <textarea
        readOnly
        rows={3}
        value={text}
        aria-labelledby={`${name}-title`}
        data-testid={name}
        onFocus={(event) => event.target.select()}
      />
    </section>
  );
}

/** An element that shows the picture alone of an address by `linkTo` in another page. */
export function frameText(link: string, title: string): string {
  const address = `${link.replace(/#.*$/, '')}&noui`;
  return `<iframe src="${escaped(address)}" title="${escaped(title)}" width="640" height="400" style="border: 0" allow="fullscreen"></iframe>`;
}
