// Small pieces that many views share.
import type { ComponentChildren } from 'preact';
import { Icon, type IconName } from './icons';
import { percent, type Badge as BadgeText } from '../words';

export function Badge({ badge }: { badge: BadgeText }) {
  return <span class={`badge ${badge.tone}`}>{badge.text}</span>;
}

export function Bar({ fraction, label, tone = 'busy' }: { fraction: number; label: string; tone?: string }) {
  return (
    <div class={`bar ${tone}`}>
      <progress max={1} value={fraction} aria-label={label} />
      <span class="figure">{percent(fraction)}</span>
    </div>
  );
}

interface ButtonProps {
  icon?: IconName;
  kind?: 'primary' | 'danger' | 'quiet';
  label?: string;  // what it is about, for those who do not see where it stands
  disabled?: boolean;
  onClick: () => void;
  children: ComponentChildren;
}

export function Button({ icon, kind, label, disabled, onClick, children }: ButtonProps) {
  return (
    <button type="button" class={`button ${kind ?? ''}`} aria-label={label} disabled={disabled ?? false} onClick={onClick}>
      {icon ? <Icon name={icon} /> : null}
      <span>{children}</span>
    </button>
  );
}

export function Empty({ title, children }: { title: string; children: ComponentChildren }) {
  return (
    <div class="empty">
      <Icon name="cube" />
      <div>
        <strong>{title}</strong>
        <div class="quiet-text">{children}</div>
      </div>
    </div>
  );
}
