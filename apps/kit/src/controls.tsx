import type { ComponentProps } from 'react';
import { Icon, type IconName } from './icon.tsx';

interface ButtonProps extends Omit<ComponentProps<'button'>, 'type'> {
  readonly testId?: string;
}

/** A button with a text. */
export function TextButton({
  look = 'outlined',
  testId,
  ...rest
}: ButtonProps & { look?: 'outlined' | 'primary' | 'plain' }) {
  return <button {...rest} type="button" className={`text-button ${look}`} data-testid={testId} />;
}

/** A button with only an icon; `label` names it for screen readers. */
export function IconButton({
  icon,
  label,
  testId,
  ...rest
}: ButtonProps & { icon: IconName; label: string }) {
  return (
    <button className="icon-button" {...rest} type="button" aria-label={label} data-testid={testId}>
      <Icon name={icon} />
    </button>
  );
}
