import { IconButton } from '@websplatter/kit/controls';
import { Icon } from '@websplatter/kit/icon';
import { useStore } from 'zustand';
import type { FailureReport } from '../state/messages.ts';
import type { ViewerStore } from '../state/store.ts';

/**
 * The error of the last scene that failed to open, or a warning about the current scene. Can be
 * dismissed.
 */
export function MessagePanel({ store, kind }: { store: ViewerStore; kind: 'error' | 'warning' }) {
  const name = kind === 'error' ? 'failure' : 'warning';
  const shown: FailureReport | null = useStore(store, (state) => state[name]);
  // The live region is always mounted: some screen readers ignore one that is added with its text.
  return (
    <div role={kind === 'error' ? 'alert' : 'status'} className="message-slot">
      {shown && (
        <section className={`panel message ${kind}`} data-testid={kind}>
          <Icon name="warning" />
          <div className="message-text">
            <h2>{shown.title}</h2>
            <p className="particulars" data-testid={`${kind}-message`}>
              {shown.message}
            </p>
            {shown.advice && <p>{shown.advice}</p>}
            {shown.details && (
              <details className="explained">
                <summary>Details</summary>
                <p className="particulars" data-testid="error-details">
                  {shown.details}
                </p>
              </details>
            )}
            {shown.links && (
              <ul className="links">
                {shown.links.map(({ label, href }) => (
                  <li key={href}>
                    <a href={href}>{label}</a>
                  </li>
                ))}
              </ul>
            )}
          </div>
          <IconButton
            icon="close"
            label={`Dismiss the ${kind}`}
            testId={`dismiss-${kind}`}
            onClick={() => store.setState({ [name]: null })}
          />
        </section>
      )}
    </div>
  );
}
