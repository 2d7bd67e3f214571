"""Pictures: gas_render, brownian_render."""
