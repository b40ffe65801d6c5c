"""From the resolved model to what the analyses take: codels to symbols, components to PSMs, deployments to task
sets.
"""
