import { TextButton } from '@websplatter/kit/controls';
import { Icon } from '@websplatter/kit/icon';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { escaped } from '../ui/html.ts';
import { copyFrame, copyLink, linkOf, noLink } from './copy-link.ts';

/** A link to the present view, and a frame of it for other pages: to be read, and to be copied. */
export function LinkSection({ store, viewer }: PanelProps) {
  // The link changes with these; a moving camera is told when it is at rest.
  useStore(store, ({ restedFrames }) => restedFrames);
  useStore(store, ({ splitPart }) => splitPart);
  useStore(store, ({ annotating }) => annotating.list);
  const scene = useStore(store, (state) => state.scene);
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
      <LinkRow name="link" title="Link" text={link} onCopy={() => void copyLink(viewer, store)} />
      <LinkRow
        name="frame"
        title="Embed code (iframe)"
        text={frame}
        onCopy={() => void copyFrame(frame, store)}
      />
    </>
  );
}

/** A text that is to be copied. */
function LinkRow({
  name,
  title,
  text,
  onCopy,
}: {
  name: 'link' | 'frame';
  title: string;
  text: string;
  onCopy: () => void;
}) {
  return (
    <section className="link-section">
      <h3 id={`${name}-title`}>{title}</h3>
      <div className="link-row">
        <input
          type="text"
          readOnly
          value={text}
          aria-labelledby={`${name}-title`}
          data-testid={name}
          onFocus={(event) => event.target.select()}
        />
        <TextButton
          look="primary"
          aria-label={`Copy the ${title.toLowerCase()}`}
          testId={`copy-${name}`}
          onClick={onCopy}
        >
          <Icon name="link" />
          Copy
        </TextButton>
      </div>
    </section>
  );
}

/** An element that shows the picture alone of an address by `linkTo` in another page. */
export function frameText(link: string, title: string): string {
  const address = `${link.replace(/#.*$/, '')}&noui`;
  return `<iframe src="${escaped(address)}" title="${escaped(title)}" width="640" height="400" style="border: 0" allow="fullscreen"></iframe>`;
}
